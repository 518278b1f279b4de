//! Deserialisers where `serde`'s own are too lenient or report no position: tables, number lists of fixed length, words, effects.

use core::fmt;
use core::marker::PhantomData;
use std::collections::BTreeMap;
use std::string::String;
use std::vec::Vec;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error, IntoDeserializer as _, MapAccess, SeqAccess, Visitor};

/// A table: `serde`'s own structures also take a list of their values, in an order that no file states.
///
/// # Errors
/// Of the deserializer, where there is no table.
pub fn table<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    deserializer.deserialize_map(Table(PhantomData))
}

/// The same for a key that may be left out.
///
/// # Errors
/// As [`table`].
pub fn table_if_given<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<T>, D::Error> {
    table(deserializer).map(Some)
}

/// A list of tables.
///
/// # Errors
/// As [`table`].
pub fn tables<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    let entries = Vec::<Entry<T>>::deserialize(deserializer)?;
    Ok(entries.into_iter().map(|Entry(table)| table).collect())
}

/// Tables by key.
///
/// # Errors
/// As [`table`].
pub fn tables_by_key<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<BTreeMap<String, T>, D::Error> {
    let entries = BTreeMap::<String, Entry<T>>::deserialize(deserializer)?;
    Ok(entries.into_iter().map(|(key, Entry(table))| (key, table)).collect())
}

struct Entry<T>(T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Entry<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        table(deserializer).map(Self)
    }
}

struct Table<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Table<T> {
    type Value = T;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<T, A::Error> {
        T::deserialize(MapAccessDeserializer::new(table))
    }
}

/// One of the words of an enumeration: `serde`'s own message for anything else does not say what was found.
///
/// # Errors
/// Of the deserializer, where there is no text or none of the words.
pub fn word<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::deserialize(String::deserialize(deserializer)?.into_deserializer())
}

/// The same for a key that may be left out.
///
/// # Errors
/// As [`word`].
pub fn word_if_given<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<T>, D::Error> {
    word(deserializer).map(Some)
}

/// So many numbers and no more: `serde`'s own arrays pass over what is too much.
///
/// # Errors
/// Of the deserializer, where the list has another length or something else than numbers.
pub fn exactly<'de, const COUNT: usize, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; COUNT], D::Error> {
    deserializer.deserialize_seq(Numbers)
}

/// The same for a key that may be left out.
///
/// # Errors
/// As [`exactly`].
pub fn exactly_if_given<'de, const COUNT: usize, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<[f64; COUNT]>, D::Error> {
    exactly(deserializer).map(Some)
}

struct Numbers<const COUNT: usize>;

impl<'de, const COUNT: usize> Visitor<'de> for Numbers<COUNT> {
    type Value = [f64; COUNT];

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "an array of length {COUNT}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let mut numbers = [0.0; COUNT];
        let mut count = 0;
        while let Some(number) = list.next_element::<f64>()? {
            if let Some(place) = numbers.get_mut(count) {
                *place = number;
            }
            count += 1;
        }
        if count == COUNT { Ok(numbers) } else { Err(A::Error::invalid_length(count, &self)) }
    }
}
