//! Reads one signal from one channel's messages, in the robot's order.

use crate::path::FieldPath;
use crate::recording::{Channel, Message};
use crate::schema::{Decoder, FieldKind, MessageType, Values};

use super::layout::{Layout, Probe, Unfit};
use super::order::Order;
use super::{Role, SignalPaths};

/// Reads the signal of a role from the messages of a channel.
#[derive(Debug)]
pub(super) struct ChannelReader {
    pub role: Role,
    decoder: Decoder,
    layout: Layout,
    order: Order,
    /// Number of leading quantities that each message must contain.
    required_count: usize,
}

/// The reason why a message gives no sample.
#[derive(Debug)]
pub(super) enum Rejection {
    /// The message is unusable, with the problem.
    Unusable(String),
    /// The message concerns other cables or frames.
    Foreign,
}

/// A decoded message: its time, and its numbers in the robot's order.
pub(super) struct Decoded<'a> {
    pub stamp_nanos: i64,
    /// Whether the time comes from the message; otherwise it is its log time.
    pub is_stamped: bool,
    role: Role,
    layout: &'a Layout,
    order: &'a Order,
    values: &'a Values,
    cable_count: usize,
}

impl ChannelReader {
    /// Finds the fields of a role with the help of a message.
    ///
    /// # Errors
    /// Returns an [`Unfit`] if the channel's messages, or this one, do not contain them.
    pub fn new(
        role: Role,
        path: &FieldPath,
        paths: &SignalPaths,
        channel: &Channel,
        message: &[u8],
    ) -> Result<Self, Unfit> {
        let (name, encoding, data) = channel.schema.as_ref().map_or(("", "", &[][..]), |schema| {
            (schema.name.as_str(), schema.encoding.as_str(), schema.data.as_slice())
        });
        let message_type = MessageType::new(&channel.message_encoding, name, encoding, data)?;
        let layout = Layout::find(role, path, &Probe { message_type: &message_type, message })?;
        let decoder = message_type.decoder(&layout.wanted)?;
        let needs_length = role == Role::Cable && paths.get(Role::Length).is_none();
        if needs_length && !layout.numbers.get(1).is_some_and(Option::is_some) {
            let is_open = message_type.field(&FieldPath::default())?.kind == FieldKind::Unknown;
            return Err(if is_open { Unfit::Message(missing(1)) } else { Unfit::NoLength });
        }
        Ok(Self { role, decoder, layout, order: Order::default(), required_count: 1 + usize::from(needs_length) })
    }

    /// Decodes a message.
    ///
    /// # Errors
    /// Returns a [`Rejection`] if it contains no sample.
    pub fn read(&mut self, message: &Message<'_>, cables: &[String]) -> Result<Decoded<'_>, Rejection> {
        let values = self.decoder.read(message.data).map_err(|error| Rejection::Unusable(error.to_string()))?;
        match self.role {
            Role::Pose | Role::Wrench => {
                let indices = || self.layout.numbers.iter().flatten();
                if !indices().all(|index| values.number(*index).is_some()) {
                    let is_foreign = indices().all(|index| values.numbers(*index).is_empty());
                    let reason = || Rejection::Unusable("it holds several of what the path selects".to_owned());
                    return Err(if is_foreign { Rejection::Foreign } else { reason() });
                }
            }
            Role::Cable | Role::Length | Role::Speed | Role::Reference => {
                let expected = match self.layout.names {
                    Some(names) => self.order.update(values.texts(names), cables)?,
                    None => cables.len(),
                };
                for (quantity, index) in self.layout.numbers.iter().enumerate() {
                    let Some(index) = *index else { continue };
                    let count = values.numbers(index).len();
                    if count == 0 && quantity < self.required_count {
                        let reason = if self.role == Role::Cable { missing(quantity) } else { NOTHING.to_owned() };
                        return Err(Rejection::Unusable(reason));
                    }
                    if count != expected && count != 0 {
                        let reason = format!("it holds {count} numbers where {expected} are expected, one per cable");
                        return Err(Rejection::Unusable(reason));
                    }
                }
            }
        }
        let mut stamps = self.layout.stamps.iter().filter_map(|index| values.time_nanos(*index));
        let stamp_nanos = stamps.find(|stamp| *stamp != 0);
        Ok(Decoded {
            stamp_nanos: stamp_nanos.unwrap_or_else(|| i64::try_from(message.log_time_nanos).unwrap_or(i64::MAX)),
            is_stamped: stamp_nanos.is_some(),
            role: self.role,
            layout: &self.layout,
            order: &self.order,
            values,
            cable_count: cables.len(),
        })
    }

    /// Describes the content of the last message if it does not concern the robot.
    pub fn describe_foreign(&self, cables: &[String]) -> String {
        match self.layout.names {
            Some(_) => self.order.describe(cables),
            None => "it holds nothing of what the path selects".to_owned(),
        }
    }
}

impl Decoded<'_> {
    /// Returns the cables without numbers, as bits.
    pub fn missing_cables(&self) -> u64 {
        self.order.missing_cables()
    }

    /// Writes the numbers: for cables one block of the robot's cables per quantity, NaN where the message has none; the block of speeds is left out
    /// if the message has no speeds.
    pub fn fill(&self, out: &mut Vec<f64>) {
        let indices = &self.layout.numbers;
        if matches!(self.role, Role::Pose | Role::Wrench) {
            out.extend(indices.iter().flatten().map(|index| self.values.number(*index).unwrap_or(f64::NAN)));
            return;
        }
        for (quantity, index) in indices.iter().enumerate() {
            let numbers = index.map_or(&[][..], |index| self.values.numbers(index));
            if numbers.is_empty() && quantity == SPEED {
                continue;
            }
            if numbers.len() == self.cable_count && (self.layout.names.is_none() || self.order.is_robots()) {
                out.extend_from_slice(numbers);
                continue;
            }
            let start = out.len();
            out.resize(start + self.cable_count, f64::NAN);
            let block = out.get_mut(start..).unwrap_or_default();
            for (cable, number) in self.order.cables().iter().zip(numbers) {
                if let Some(place) = cable.and_then(|cable| block.get_mut(cable)) {
                    *place = *number;
                }
            }
        }
    }
}

/// Index of the speed among the quantities of the cable signal.
const SPEED: usize = 2;
const NOTHING: &str = "it holds no numbers";

/// Returns the message about a missing quantity of the cable signal.
fn missing(quantity: usize) -> String {
    if quantity == 0 {
        return "it brings no forces (`effort`); name the topic or path of the sensor forces as `cable` under `[log]` in \
                the robot file"
            .to_owned();
    }
    "it brings no cable lengths (`position`); name the topic or path of the lengths as `length` under `[log]` in the \
     robot file"
        .to_owned()
}
