//! The grammar of message paths.

use super::{Condition, FieldPath, Literal, MessagePath, PathError, Selection, Step};

const TOPIC: &str = "a topic such as `/cable_states`";
const NAME: &str = "a field name";
const NEXT: &str = "`.field`, `[index]`, `{filter}` or the end";
const AFTER_TOPIC: &str = "`.field`, `{filter}` or the end";
const INDEX: &str = "an index or a slice such as `[2]`, `[1:4]` or `[:]`";
const INDEX_END: &str = "`]`";
const COMPARISON: &str = "`==` or `!=`";
const LITERAL: &str = "a text in quotes, a whole number, `true` or `false`";
const FILTER_END: &str = "`}`";
const TEXT_END: &str = "the closing quote";

/// Whether a topic may contain the character without quotes.
pub(super) fn is_topic_character(character: char) -> bool {
    !character.is_whitespace() && !matches!(character, '.' | '[' | ']' | '{' | '}' | '"')
}

/// Whether a field name may contain the character without quotes.
pub(super) fn is_name_character(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

pub(super) fn message_path(text: &str) -> Result<MessagePath, PathError> {
    let mut parser = Parser { text, offset: 0 };
    let topic = parser.name(TOPIC, is_topic_character)?;
    let steps = match parser.peek() {
        Some('[') => return Err(parser.error(AFTER_TOPIC)),
        _ => parser.steps(false)?,
    };
    Ok(MessagePath { topic, field: FieldPath { steps } })
}

pub(super) fn field_path(text: &str) -> Result<FieldPath, PathError> {
    let mut parser = Parser { text, offset: 0 };
    let starts_with_name = !matches!(parser.peek(), None | Some('.' | '[' | '{'));
    Ok(FieldPath { steps: parser.steps(starts_with_name)? })
}

struct Parser<'a> {
    text: &'a str,
    offset: usize,
}

impl Parser<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.offset..).unwrap_or_default()
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn take(&mut self, wanted: &str) -> bool {
        let found = self.rest().starts_with(wanted);
        if found {
            self.offset += wanted.len();
        }
        found
    }

    fn spaces(&mut self) {
        while self.take(" ") {}
    }

    fn error(&self, expected: &'static str) -> PathError {
        PathError {
            path: self.text.to_owned(),
            position: self.text.get(..self.offset).map_or(0, |before| before.chars().count()) + 1,
            expected,
            found: match self.peek() {
                Some(character) => format!("`{character}`"),
                None => "the end".to_owned(),
            },
        }
    }

    fn steps(&mut self, starts_with_name: bool) -> Result<Vec<Step>, PathError> {
        let mut steps = Vec::new();
        if starts_with_name {
            steps.push(Step::Member(self.name(NAME, is_name_character)?));
        }
        while let Some(character) = self.peek() {
            steps.push(match character {
                '.' => {
                    self.offset += 1;
                    Step::Member(self.name(NAME, is_name_character)?)
                }
                '[' => {
                    self.offset += 1;
                    Step::Elements(self.selection()?)
                }
                '{' => {
                    self.offset += 1;
                    Step::Where(self.condition()?)
                }
                _ => return Err(self.error(NEXT)),
            });
        }
        Ok(steps)
    }

    fn name(&mut self, expected: &'static str, allowed: fn(char) -> bool) -> Result<String, PathError> {
        if self.peek() == Some('"') {
            return match self.quoted()? {
                name if name.is_empty() => Err(self.error(expected)),
                name => Ok(name),
            };
        }
        let length = self.rest().find(|character| !allowed(character)).unwrap_or(self.rest().len());
        if length == 0 {
            return Err(self.error(expected));
        }
        let name = self.rest().get(..length).unwrap_or_default().to_owned();
        self.offset += length;
        Ok(name)
    }

    /// Parses a text in single or double quotes; a backslash escapes the next character.
    fn quoted(&mut self) -> Result<String, PathError> {
        let mut text = String::new();
        let mut quote = None;
        let mut escaped = false;
        while let Some(character) = self.peek() {
            self.offset += character.len_utf8();
            match quote {
                None => quote = Some(character),
                Some(_) if escaped => {
                    escaped = false;
                    text.push(character);
                }
                Some(_) if character == '\\' => escaped = true,
                Some(quote) if character == quote => return Ok(text),
                Some(_) => text.push(character),
            }
        }
        Err(self.error(TEXT_END))
    }

    fn selection(&mut self) -> Result<Selection, PathError> {
        let first = self.integer(INDEX)?;
        let selection = if self.take(":") {
            let last = self.integer(INDEX)?;
            Selection::Slice { first, last }
        } else {
            Selection::One(first.ok_or_else(|| self.error(INDEX))?)
        };
        if self.take("]") { Ok(selection) } else { Err(self.error(INDEX_END)) }
    }

    /// Parses an integer; `None` if there is neither a digit nor a minus sign.
    fn integer(&mut self, expected: &'static str) -> Result<Option<i64>, PathError> {
        let sign = usize::from(self.peek() == Some('-'));
        let digits = self.rest().get(sign..).unwrap_or_default();
        let length = sign + digits.find(|character: char| !character.is_ascii_digit()).unwrap_or(digits.len());
        if length == 0 {
            return Ok(None);
        }
        let value = self.rest().get(..length).unwrap_or_default().parse();
        let value = value.map_err(|_| self.error(expected))?;
        self.offset += length;
        Ok(Some(value))
    }

    fn condition(&mut self) -> Result<Condition, PathError> {
        self.spaces();
        let mut member = vec![self.name(NAME, is_name_character)?];
        while self.take(".") {
            member.push(self.name(NAME, is_name_character)?);
        }
        self.spaces();
        let equal = self.take("==");
        if !equal && !self.take("!=") {
            return Err(self.error(COMPARISON));
        }
        self.spaces();
        let value = if matches!(self.peek(), Some('"' | '\'')) {
            Literal::Text(self.quoted()?)
        } else if self.take("true") {
            Literal::Integer(1)
        } else if self.take("false") {
            Literal::Integer(0)
        } else {
            let value = self.integer(LITERAL)?;
            Literal::Integer(value.ok_or_else(|| self.error(LITERAL))?)
        };
        self.spaces();
        if self.take("}") { Ok(Condition { member, equal, value }) } else { Err(self.error(FILTER_END)) }
    }
}
