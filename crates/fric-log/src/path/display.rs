//! Formats message paths in their notation.

use std::fmt::{self, Display, Formatter, Write as _};

use super::parse::{is_name_character, is_topic_character};
use super::{Condition, FieldPath, Literal, MessagePath, Selection, Step};

impl Display for MessagePath {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        name(f, &self.topic, is_topic_character)?;
        if matches!(self.field.steps().first(), Some(Step::Member(_))) {
            f.write_char('.')?;
        }
        Display::fmt(&self.field, f)
    }
}

impl Display for FieldPath {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (index, step) in self.steps().iter().enumerate() {
            if index > 0 && matches!(step, Step::Member(_)) {
                f.write_char('.')?;
            }
            Display::fmt(step, f)?;
        }
        Ok(())
    }
}

impl Display for Step {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Member(member) => name(f, member, is_name_character),
            Self::Elements(selection) => Display::fmt(selection, f),
            Self::Where(condition) => Display::fmt(condition, f),
        }
    }
}

impl Display for Selection {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(index) => write!(f, "[{index}]"),
            Self::Slice { first, last } => {
                f.write_char('[')?;
                if let Some(first) = first {
                    write!(f, "{first}")?;
                }
                f.write_char(':')?;
                if let Some(last) = last {
                    write!(f, "{last}")?;
                }
                f.write_char(']')
            }
        }
    }
}

impl Display for Condition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_char('{')?;
        for (index, member) in self.member.iter().enumerate() {
            if index > 0 {
                f.write_char('.')?;
            }
            name(f, member, is_name_character)?;
        }
        f.write_str(if self.equal { "==" } else { "!=" })?;
        match &self.value {
            Literal::Text(text) => quoted(f, text)?,
            Literal::Integer(value) => write!(f, "{value}")?,
        }
        f.write_char('}')
    }
}

fn name(f: &mut Formatter<'_>, text: &str, plain: fn(char) -> bool) -> fmt::Result {
    if !text.is_empty() && text.chars().all(plain) { f.write_str(text) } else { quoted(f, text) }
}

fn quoted(f: &mut Formatter<'_>, text: &str) -> fmt::Result {
    f.write_char('"')?;
    for character in text.chars() {
        if matches!(character, '"' | '\\') {
            f.write_char('\\')?;
        }
        f.write_char(character)?;
    }
    f.write_char('"')
}
