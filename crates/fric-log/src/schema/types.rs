//! The message types that a `ros2msg` schema describes, each stored once and referenced by index.

/// A number type of ROS 2, named as in message definitions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Primitive {
    Bool,
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Int64,
    Uint64,
    Float32,
    Float64,
}

impl Primitive {
    /// Returns the type of this name; `byte` and `char` are unsigned bytes in ROS 2.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "bool" => Self::Bool,
            "int8" => Self::Int8,
            "byte" | "char" | "uint8" => Self::Uint8,
            "int16" => Self::Int16,
            "uint16" => Self::Uint16,
            "int32" => Self::Int32,
            "uint32" => Self::Uint32,
            "int64" => Self::Int64,
            "uint64" => Self::Uint64,
            "float32" => Self::Float32,
            "float64" => Self::Float64,
            _ => return None,
        })
    }

    /// Returns the name in message definitions.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Bool => "bool",
            Self::Int8 => "int8",
            Self::Uint8 => "uint8",
            Self::Int16 => "int16",
            Self::Uint16 => "uint16",
            Self::Int32 => "int32",
            Self::Uint32 => "uint32",
            Self::Int64 => "int64",
            Self::Uint64 => "uint64",
            Self::Float32 => "float32",
            Self::Float64 => "float64",
        }
    }

    /// Returns the encoded size, in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Bool | Self::Int8 | Self::Uint8 => 1,
            Self::Int16 | Self::Uint16 => 2,
            Self::Int32 | Self::Uint32 | Self::Float32 => 4,
            Self::Int64 | Self::Uint64 | Self::Float64 => 8,
        }
    }
}

/// The type of a field, or of each element of an array field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Element {
    Number(Primitive),
    Text,
    WideText,
    /// Index into [`TypeTable::messages`].
    Message(usize),
}

/// The number of elements of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Count {
    One,
    Fixed(usize),
    /// The number is stated in the message; a bound in the schema is not checked.
    Sequence,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Field {
    pub name: String,
    pub element: Element,
    pub count: Count,
}

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Message {
    /// `package/Type`, without `/msg`.
    pub name: String,
    pub fields: Vec<Field>,
    /// Whether the message is a time stamp or a duration.
    pub time: bool,
    /// Minimum number of bytes of a message of this type.
    pub min_bytes: usize,
    /// The encoding as one block, for plain CDR and for plain CDR2.
    blocks: [Option<Block>; 2],
}

/// An encoding that starts at a multiple of `align` and always takes `size` bytes, also a multiple.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Block {
    pub align: usize,
    pub size: usize,
}

impl Message {
    pub(super) fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Returns the encoding as one block if numbers are aligned to at most `max_align`, 8 or 4.
    pub(super) fn block(&self, max_align: usize) -> Option<Block> {
        let [cdr1, cdr2] = self.blocks;
        if max_align == 8 { cdr1 } else { cdr2 }
    }
}

/// All types of a schema. No type contains itself, and nesting is limited.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct TypeTable {
    messages: Vec<Message>,
    /// Index of the schema's own type.
    pub root: usize,
}

impl TypeTable {
    /// Adds a type whose members' types are already in the table. Returns its index.
    pub(super) fn push(&mut self, name: String, fields: Vec<Field>, time: bool) -> usize {
        let bytes = |field: &Field| {
            let one = self.min_bytes(field.element);
            match field.count {
                Count::One => one,
                Count::Fixed(count) => one.saturating_mul(count),
                Count::Sequence => 4,
            }
        };
        let min_bytes = fields.iter().map(bytes).fold(0, usize::saturating_add);
        let blocks = [self.block(&fields, 8), self.block(&fields, 4)];
        self.messages.push(Message {
            name,
            fields,
            time,
            // An empty structure takes one byte.
            min_bytes: min_bytes.max(1),
            blocks,
        });
        self.messages.len() - 1
    }

    /// Returns the type with this index. An unknown index gives an empty message.
    pub(super) fn message(&self, index: usize) -> &Message {
        static NOTHING: Message =
            Message { name: String::new(), fields: Vec::new(), time: false, min_bytes: 1, blocks: [None; 2] };
        self.messages.get(index).unwrap_or(&NOTHING)
    }

    pub(super) fn position(&self, name: &str) -> Option<usize> {
        self.messages.iter().position(|message| message.name == name)
    }

    /// Returns the minimum number of bytes of one element.
    pub(super) fn min_bytes(&self, element: Element) -> usize {
        match element {
            Element::Number(primitive) => primitive.size(),
            Element::Text | Element::WideText => 4,
            Element::Message(index) => self.message(index).min_bytes,
        }
    }

    pub(super) fn element_name(&self, element: Element) -> &str {
        match element {
            Element::Number(primitive) => primitive.name(),
            Element::Text => "string",
            Element::WideText => "wstring",
            Element::Message(index) => &self.message(index).name,
        }
    }

    /// Returns the fields as one block, if the first one has the strictest alignment and the end keeps it.
    fn block(&self, fields: &[Field], max_align: usize) -> Option<Block> {
        let mut whole: Option<Block> = None;
        for field in fields {
            let one = match field.element {
                Element::Number(primitive) => Block { align: primitive.size().min(max_align), size: primitive.size() },
                // CDR2 puts sizes before arrays of messages.
                Element::Message(_) if field.count != Count::One && max_align < 8 => return None,
                Element::Message(index) => self.message(index).block(max_align)?,
                Element::Text | Element::WideText => return None,
            };
            let size = match field.count {
                Count::One => one.size,
                Count::Fixed(count) => one.size.checked_mul(count)?,
                Count::Sequence => return None,
            };
            let before = whole.unwrap_or(Block { align: one.align, size: 0 });
            if one.align > before.align {
                return None;
            }
            let start = before.size.checked_next_multiple_of(one.align)?;
            whole = Some(Block { align: before.align, size: start.checked_add(size)? });
        }
        match whole {
            None => Some(Block { align: 1, size: 1 }),
            Some(block) => block.size.is_multiple_of(block.align).then_some(block),
        }
    }
}
