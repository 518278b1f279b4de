//! Assigns the entries of a message to cables, by name and never by position.

use crate::schema::Texts;

use super::channel::Rejection;

/// The order of a channel's messages, determined anew whenever their names change.
#[derive(Debug, Default)]
pub(super) struct Order {
    revision: Option<u64>,
    /// For each entry of a message, its cable.
    cables: Vec<Option<usize>>,
    is_robots: bool,
    is_foreign: bool,
    missing_cables: u64,
    twice: Option<String>,
    /// The names of a message about other cables, as far as an error shows them.
    names: Vec<String>,
}

impl Order {
    /// Processes a message's names and returns their number.
    ///
    /// # Errors
    /// Returns a [`Rejection`] if none is the robot's, or one occurs twice.
    #[inline]
    pub fn update(&mut self, names: &Texts, cables: &[String]) -> Result<usize, Rejection> {
        if self.revision != Some(names.revision()) {
            self.find(names, cables);
        }
        if self.is_foreign {
            return Err(Rejection::Foreign);
        }
        match &self.twice {
            Some(name) => Err(Rejection::Unusable(format!("it names `{name}` twice"))),
            None => Ok(self.cables.len()),
        }
    }

    /// Returns the cable of each entry of a message.
    pub fn cables(&self) -> &[Option<usize>] {
        &self.cables
    }

    /// Whether the entries are the robot's cables in the robot's order.
    pub fn is_robots(&self) -> bool {
        self.is_robots
    }

    /// Returns the cables that a message does not name, as bits; none if messages have no names. Cables past the 64th, which no compensator supports,
    /// share a bit.
    pub fn missing_cables(&self) -> u64 {
        self.missing_cables
    }

    /// Describes the names that are not the robot's cables.
    pub fn describe(&self, cables: &[String]) -> String {
        let found = if self.names.is_empty() { "nothing at all".to_owned() } else { self.names.join(", ") };
        format!("it names none of the robot's cables ({}), but {found}", cables.join(", "))
    }

    #[cold]
    fn find(&mut self, names: &Texts, cables: &[String]) {
        self.revision = Some(names.revision());
        self.cables.clear();
        self.cables.extend(names.iter().map(|name| cables.iter().position(|cable| cable == name)));
        self.is_robots = names.len() == cables.len() && self.cables.iter().copied().eq((0..cables.len()).map(Some));
        self.is_foreign = !self.cables.iter().any(Option::is_some);
        let missing = (0..cables.len()).filter(|cable| !self.cables.contains(&Some(*cable)));
        self.missing_cables = missing.fold(0, |bits, cable| bits | 1 << cable.min(63));
        let shown = if self.is_foreign { 8 } else { 0 };
        self.names = names.iter().take(shown).map(str::to_owned).collect();
        let is_twice = |cable: usize| self.cables.iter().filter(|entry| **entry == Some(cable)).count() > 1;
        self.twice = (0..cables.len()).find(|cable| is_twice(*cable)).and_then(|cable| cables.get(cable)).cloned();
    }
}
