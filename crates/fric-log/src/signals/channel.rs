//! One signal out of one channel's messages, in the robot's order.

use crate::path::FieldPath;
use crate::recording::{Channel, Message};
use crate::schema::{Decoder, MessageType, SchemaError, Values};

use super::Role;
use super::layout::{Layout, Probe};

/// Reads the signal of a role from the messages of a channel.
#[derive(Debug)]
pub(super) struct ChannelReader {
    pub role: Role,
    decoder: Decoder,
    layout: Layout,
    /// For each entry of a message, the cable it is of.
    order: Vec<Option<usize>>,
    order_revision: Option<u64>,
}

/// A decoded message: its time, and its numbers in the robot's order.
pub(super) struct Decoded<'a> {
    pub stamp_nanos: i64,
    reader: &'a Layout,
    role: Role,
    order: &'a [Option<usize>],
    values: &'a Values,
    cable_count: usize,
}

impl ChannelReader {
    /// Finds the fields of a role.
    ///
    /// # Errors
    /// [`SchemaError`] where the channel's messages do not have them.
    pub fn new(role: Role, path: &FieldPath, channel: &Channel, first_message: &[u8]) -> Result<Self, SchemaError> {
        let (name, encoding, data) = channel.schema.as_ref().map_or(("", "", &[][..]), |schema| {
            (schema.name.as_str(), schema.encoding.as_str(), schema.data.as_slice())
        });
        let message_type = MessageType::new(&channel.message_encoding, name, encoding, data)?;
        let layout = Layout::find(role, path, &Probe { message_type: &message_type, first_message })?;
        let decoder = message_type.decoder(&layout.wanted)?;
        Ok(Self { role, decoder, layout, order: Vec::new(), order_revision: None })
    }

    /// Whether the messages bring a number of its own for the n-th quantity of the role.
    pub fn has_quantity(&self, index: usize) -> bool {
        self.layout.numbers.get(index).is_some_and(Option::is_some)
    }

    /// Decodes a message.
    ///
    /// # Errors
    /// A sentence that says what is wrong with it.
    pub fn read(&mut self, message: &Message<'_>, cables: &[String]) -> Result<Decoded<'_>, String> {
        let values = self.decoder.read(message.data).map_err(|error| error.to_string())?;
        if let Some(names) = self.layout.names {
            let names = values.texts(names);
            if self.order_revision != Some(names.revision()) {
                self.order.clear();
                self.order.extend(names.iter().map(|name| cables.iter().position(|cable| cable == name)));
                self.order_revision = Some(names.revision());
                if !self.order.iter().any(Option::is_some) {
                    let found: Vec<&str> = names.iter().take(8).collect();
                    self.order_revision = None;
                    return Err(format!(
                        "it names none of the robot's cables ({}), but {}",
                        cables.join(", "),
                        if found.is_empty() { "nothing at all".to_owned() } else { found.join(", ") }
                    ));
                }
            }
        }
        match self.role {
            Role::Pose | Role::Wrench => {
                // A filter that matches nothing, or several, gives no one pose.
                if !self.layout.numbers.iter().flatten().all(|index| values.number(*index).is_some()) {
                    return Err("it does not hold exactly one of what the path selects".to_owned());
                }
            }
            Role::Cable | Role::Length | Role::Speed | Role::Reference => {
                let expected = if self.layout.names.is_some() { self.order.len() } else { cables.len() };
                for index in self.layout.numbers.iter().flatten() {
                    let count = values.numbers(*index).len();
                    if count != expected && (count != 0 || self.layout.names.is_none()) {
                        return Err(format!("it holds {count} numbers where {expected} are expected, one per cable"));
                    }
                }
            }
        }
        let stamp_nanos = self.layout.stamp.and_then(|index| values.time_nanos(index)).filter(|&stamp| stamp != 0);
        Ok(Decoded {
            stamp_nanos: stamp_nanos.unwrap_or_else(|| i64::try_from(message.log_time_nanos).unwrap_or(i64::MAX)),
            reader: &self.layout,
            role: self.role,
            order: &self.order,
            values,
            cable_count: cables.len(),
        })
    }
}

impl Decoded<'_> {
    /// Writes the numbers: for cables one block of the robot's cables per quantity, NaN where the message has none.
    pub fn fill(&self, out: &mut Vec<f64>) {
        match self.role {
            Role::Pose | Role::Wrench => {
                let numbers = self.reader.numbers.iter().flatten();
                out.extend(numbers.map(|index| self.values.number(*index).unwrap_or(f64::NAN)));
            }
            Role::Cable | Role::Length | Role::Speed | Role::Reference => {
                for quantity in &self.reader.numbers {
                    let start = out.len();
                    out.resize(start + self.cable_count, f64::NAN);
                    let block = out.get_mut(start..).unwrap_or_default();
                    let numbers = quantity.map_or(&[][..], |index| self.values.numbers(index));
                    if self.reader.names.is_none() {
                        for (place, number) in block.iter_mut().zip(numbers) {
                            *place = *number;
                        }
                        continue;
                    }
                    for (cable, number) in self.order.iter().zip(numbers) {
                        if let Some(place) = cable.and_then(|cable| block.get_mut(cable)) {
                            *place = *number;
                        }
                    }
                }
            }
        }
    }
}
