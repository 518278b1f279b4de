//! Numbers of results.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// Numbers by name, in order.
#[derive(Clone, Debug, Default)]
pub struct Numbers(pub Vec<(String, f64)>);

impl Numbers {
    /// Returns the number of a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(of, _)| of == name).map(|(_, value)| *value)
    }
}

impl Serialize for Numbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}
