//! Errors of the values that a robot file states.

use std::borrow::ToOwned;
use std::fmt;
use std::string::String;
use std::vec::Vec;

use thiserror::Error;

use super::locate::Step;

/// Errors of [`RobotOptions`](super::file::RobotOptions): the key and the problem.
#[derive(Clone, Debug, PartialEq, Error)]
pub struct OptionsError {
    pub(super) path: Vec<Step>,
    pub(super) cable: Option<String>,
    key: String,
    problem: String,
}

impl OptionsError {
    pub(super) fn new(path: &[Step], key: &str, problem: String) -> Self {
        Self { path: path.to_vec(), cable: None, key: key.to_owned(), problem }
    }
}

impl fmt::Display for OptionsError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(cable) = &self.cable {
            write!(formatter, "cable \"{cable}\": ")?;
        }
        write!(formatter, "`{}` {}", self.key, self.problem)
    }
}
