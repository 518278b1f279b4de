//! `ros2msg` types as seen by field lookup.

use crate::schema::field::{FieldKind, TypeNode};
use crate::schema::types::{Count, Element, TypeTable};

#[derive(Clone, Copy)]
pub(in crate::schema) struct RosNode<'a> {
    types: &'a TypeTable,
    element: Element,
    array: bool,
}

impl<'a> RosNode<'a> {
    pub(in crate::schema) fn root(types: &'a TypeTable) -> Self {
        Self { types, element: Element::Message(types.root), array: false }
    }
}

impl TypeNode for RosNode<'_> {
    fn kind(&self) -> FieldKind {
        match self.element {
            Element::Number(_) => FieldKind::Number,
            Element::Text | Element::WideText => FieldKind::Text,
            Element::Message(index) if self.types.message(index).time => FieldKind::Time,
            Element::Message(_) => FieldKind::Message,
        }
    }

    fn type_name(&self) -> String {
        self.types.element_name(self.element).to_owned()
    }

    fn is_array(&self) -> bool {
        self.array
    }

    fn element(self) -> Self {
        Self { array: false, ..self }
    }

    fn member(&self, name: &str) -> Option<Self> {
        let Element::Message(index) = self.element else {
            return None;
        };
        let field = self.types.message(index).field(name)?;
        Some(Self { types: self.types, element: field.element, array: field.count != Count::One })
    }

    fn member_names(&self) -> Vec<String> {
        let Element::Message(index) = self.element else {
            return Vec::new();
        };
        let fields = &self.types.message(index).fields;
        fields.iter().map(|field| field.name.clone()).collect()
    }
}
