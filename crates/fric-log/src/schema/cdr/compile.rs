//! Compiles types and wanted fields to a [`Program`].

use crate::path::{Condition, FieldPath, Selection, Step};
use crate::schema::error::SchemaError;
use crate::schema::field::Wanted;
use crate::schema::types::{Count, Element, Field, TypeTable};

use super::emit::{Compiler, Generation, MAX_OPS, Place, Shared};
use super::program::{Elements, Filter, Length, Op, Program};

/// Returns the program that reads the wanted fields, and the number of slots that it needs.
///
/// The wanted fields must have been checked against the types; field `i` goes to slot `i`.
pub(super) fn compile(
    types: &TypeTable,
    wanted: &[Wanted],
    generation: Generation,
) -> Result<(Program, usize), SchemaError> {
    let mut shared = Shared { types, generation, slots: wanted.len(), ops_left: MAX_OPS };
    let mut compiler = Compiler {
        shared: &mut shared,
        program: Program::default(),
        place: Place { modulus: 8, residue: 0 },
        once: true,
        wide: None,
    };
    let wants: Vec<Want<'_>> = wanted
        .iter()
        .enumerate()
        .map(|(slot, wanted)| Want { path: &wanted.path, steps: wanted.path.steps(), slot })
        .collect();
    compiler.element(Element::Message(types.root), &wants, "")?;
    let program = compiler.program;
    Ok((program, shared.slots))
}

/// A wanted field as seen from inside the message, with the remaining steps.
#[derive(Clone, Copy)]
struct Want<'a> {
    path: &'a FieldPath,
    steps: &'a [Step],
    slot: usize,
}

impl<'t> Compiler<'_, 't> {
    /// Skips, or reads, one element that is not part of an array.
    fn element(&mut self, element: Element, wants: &[Want<'_>], name: &str) -> Result<(), SchemaError> {
        let types: &'t TypeTable = self.shared.types;
        match (element, wants) {
            (Element::Number(primitive), []) => self.skip(primitive.size(), primitive.size(), name),
            (Element::Text, []) => {
                self.align(4, name)?;
                let length = Length::Fixed(1);
                self.push(Op::SkipTexts { length }, Place::UNKNOWN, name)
            }
            (Element::WideText, []) => {
                self.wide.get_or_insert_with(|| name.to_owned());
                Ok(())
            }
            (Element::Message(index), []) => match types.message(index).block(self.max_align()) {
                Some(block) => self.skip(block.align, block.size, name),
                None => self.members(index, &[], name),
            },
            (_, [want, rest @ ..]) => {
                let key = |want: &Want<'_>| want.steps.first().filter(|step| is_where(step)).cloned();
                let leaf = |want: &Want<'_>| want.steps.is_empty();
                let together = |other: &Want<'_>| !leaf(want) && !leaf(other) && key(want) == key(other);
                if !rest.iter().all(together) {
                    let groups = group(wants, |a, b| !leaf(a) && !leaf(b) && key(a) == key(b));
                    return self.each(&groups, name, |compiler, group| compiler.element(element, group, name));
                }
                match (element, want.steps) {
                    (Element::Number(primitive), _) => {
                        self.readable(want.path)?;
                        self.align(primitive.size(), name)?;
                        let after = self.place_after(primitive.size());
                        let slot = want.slot;
                        self.push(Op::Number { primitive, slot }, after, name)
                    }
                    (Element::Text, _) => self.texts(Length::Fixed(1), Selection::ALL, want, name),
                    (Element::WideText, _) => {
                        self.wide.get_or_insert_with(|| name.to_owned());
                        self.readable(want.path)
                    }
                    (Element::Message(_), []) => {
                        self.readable(want.path)?;
                        self.align(4, name)?;
                        let after = self.place_after(8);
                        self.push(Op::Time { slot: want.slot }, after, name)
                    }
                    (Element::Message(_), [Step::Where(condition), ..]) => self.filter(element, condition, wants, name),
                    (Element::Message(index), _) => self.members(index, wants, name),
                }
            }
        }
    }

    /// Processes all fields of a message in order.
    fn members(&mut self, index: usize, wants: &[Want<'_>], name: &str) -> Result<(), SchemaError> {
        let types: &'t TypeTable = self.shared.types;
        let message = types.message(index);
        if message.fields.is_empty() {
            return self.skip(1, 1, name);
        }
        for field in &message.fields {
            let inside: Vec<Want<'_>> = wants
                .iter()
                .filter_map(|want| match want.steps.split_first() {
                    Some((Step::Member(member), steps)) if *member == field.name => Some(Want { steps, ..*want }),
                    _ => None,
                })
                .collect();
            let name = match name {
                "" => field.name.clone(),
                _ => format!("{name}.{}", field.name),
            };
            self.field(field, &inside, &name)?;
        }
        Ok(())
    }

    fn field(&mut self, field: &Field, wants: &[Want<'_>], name: &str) -> Result<(), SchemaError> {
        let length = match field.count {
            Count::One => return self.element(field.element, wants, name),
            Count::Fixed(count) => Length::Fixed(count),
            Count::Sequence => Length::Counted,
        };
        // Of wants with the same selection, those that end here each need an op of their own.
        let same = |a: &Want<'_>, b: &Want<'_>| {
            let is_message = matches!(field.element, Element::Message(_));
            is_message && selection(a).0 == selection(b).0
        };
        let groups = group(wants, same);
        match groups.as_slice() {
            [] => self.skip_array(field.element, length, name),
            groups => {
                self.each(groups, name, |compiler, group| compiler.read_array(field.element, length, group, name))
            }
        }
    }

    fn skip_array(&mut self, element: Element, length: Length, name: &str) -> Result<(), SchemaError> {
        let types: &'t TypeTable = self.shared.types;
        let (size, align) = match element {
            Element::Number(primitive) => (primitive.size(), primitive.size()),
            Element::Text => {
                self.start_array(element, name)?;
                self.align(4, name)?;
                return self.push(Op::SkipTexts { length }, Place::UNKNOWN, name);
            }
            Element::WideText => {
                self.wide.get_or_insert_with(|| name.to_owned());
                return Ok(());
            }
            Element::Message(index) => match types.message(index).block(self.max_align()) {
                Some(block) => (block.size, block.align),
                None => return self.read_array(element, length, &[], name),
            },
        };
        self.start_array(element, name)?;
        match length {
            Length::Fixed(count) => self.skip(align, size.saturating_mul(count), name),
            Length::Counted => {
                self.align(4, name)?;
                let align = align.min(self.max_align());
                let after = Place::after_sequence(size);
                self.push(Op::SkipBlocks { size, align }, after, name)
            }
        }
    }

    /// Reads an array whose wants all have the same selection.
    fn read_array(
        &mut self,
        element: Element,
        length: Length,
        wants: &[Want<'_>],
        name: &str,
    ) -> Result<(), SchemaError> {
        self.start_array(element, name)?;
        let chosen = wants.first().map_or(Selection::ALL, |want| selection(want).0);
        match (element, wants.first()) {
            (Element::Number(primitive), Some(want)) => {
                self.readable(want.path)?;
                let align = primitive.size().min(self.max_align());
                let after = match length {
                    Length::Counted => {
                        self.align(4, name)?;
                        Place::after_sequence(primitive.size())
                    }
                    Length::Fixed(count) => {
                        self.align(align, name)?;
                        self.place_after(primitive.size().saturating_mul(count))
                    }
                };
                let op = Op::Numbers { primitive, align, length, selection: chosen, slot: want.slot };
                self.push(op, after, name)
            }
            (Element::Text, Some(want)) => self.texts(length, chosen, want, name),
            (Element::WideText, Some(want)) => {
                self.wide.get_or_insert_with(|| name.to_owned());
                self.readable(want.path)
            }
            _ => {
                if let Length::Counted = length {
                    self.align(4, name)?;
                }
                let inside: Vec<Want<'_>> =
                    wants.iter().map(|want| Want { steps: selection(want).1, ..*want }).collect();
                let inner = format!("{name}[]");
                let mut selected = self.part(Place::UNKNOWN, false);
                selected.element(element, &inside, &inner)?;
                let (selected, wide) = (selected.program, selected.wide);
                let mut others = self.part(Place::UNKNOWN, false);
                if chosen != Selection::ALL {
                    others.element(element, &[], &inner)?;
                }
                let others = others.program;
                self.wide = wide;
                match wants.first() {
                    Some(want) => self.readable(want.path)?,
                    None if self.wide.is_some() => return Ok(()),
                    None => {}
                }
                let min_bytes = self.shared.types.min_bytes(element);
                let op = Op::Elements(Box::new(Elements { length, min_bytes, selection: chosen, selected, others }));
                self.push(op, Place::UNKNOWN, name)
            }
        }
    }

    fn texts(&mut self, length: Length, selection: Selection, want: &Want<'_>, name: &str) -> Result<(), SchemaError> {
        self.readable(want.path)?;
        self.align(4, name)?;
        let op = Op::Texts { length, selection, slot: want.slot, once: self.once };
        self.push(op, Place::UNKNOWN, name)
    }

    /// Reads a message whose wanted fields share a condition.
    fn filter(
        &mut self,
        element: Element,
        condition: &Condition,
        wants: &[Want<'_>],
        name: &str,
    ) -> Result<(), SchemaError> {
        let slot = self.shared.slots;
        self.shared.slots += 1;
        let members: Vec<Step> = condition.member.iter().cloned().map(Step::Member).collect();
        let path = wants.first().map_or_else(FieldPath::default, |want| want.path.clone());
        let tested = [Want { path: &path, steps: &members, slot }];
        let inside: Vec<Want<'_>> =
            wants.iter().map(|want| Want { steps: want.steps.get(1..).unwrap_or_default(), ..*want }).collect();
        let mut test = self.part(self.place, false);
        test.element(element, &tested, name)?;
        let mut test = test.program;
        while test.ops.last().is_some_and(Op::only_skips) {
            test.ops.pop();
        }
        let mut failed = self.part(self.place, false);
        failed.element(element, &[], name)?;
        let failed = failed.program;
        let mut passed = self.part(self.place, false);
        passed.element(element, &inside, name)?;
        let (passed, after, wide) = (passed.program, passed.place, passed.wide);
        self.wide = wide;
        let filter = Filter { test, slot, equal: condition.equal, value: condition.value.clone(), passed, failed };
        self.push(Op::Filter(Box::new(filter)), after, name)
    }

    /// Compiles groups of wants that cannot be read in one pass.
    fn each(
        &mut self,
        groups: &[Vec<Want<'_>>],
        name: &str,
        mut compile: impl FnMut(&mut Compiler<'_, 't>, &[Want<'_>]) -> Result<(), SchemaError>,
    ) -> Result<(), SchemaError> {
        if let [only] = groups {
            return compile(self, only);
        }
        let mut programs = Vec::with_capacity(groups.len());
        let mut after = (self.place, self.wide.clone());
        for group in groups {
            let mut part = self.part(self.place, self.once);
            compile(&mut part, group)?;
            after = (part.place, part.wide);
            programs.push(part.program);
        }
        self.wide = after.1;
        self.push(Op::Each(programs), after.0, name)
    }
}

fn is_where(step: &Step) -> bool {
    matches!(step, Step::Where(_))
}

/// Returns the selection that a want starts with (all elements if it states none), and the steps after it.
fn selection<'a>(want: &Want<'a>) -> (Selection, &'a [Step]) {
    match want.steps.split_first() {
        Some((Step::Elements(selection), rest)) => (*selection, rest),
        _ => (Selection::ALL, want.steps),
    }
}

/// Sorts wants into groups of which any two are `same`, in the order of their first members.
fn group<'a>(wants: &[Want<'a>], same: impl Fn(&Want<'a>, &Want<'a>) -> bool) -> Vec<Vec<Want<'a>>> {
    let mut groups: Vec<Vec<Want<'a>>> = Vec::new();
    for want in wants {
        let known = groups.iter_mut().find(|group| group.first().is_some_and(|first| same(first, want)));
        match known {
            Some(group) => group.push(*want),
            None => groups.push(vec![*want]),
        }
    }
    groups
}
