//! Reading recordings: order, damage, hostile files.

mod conformance;
mod cuts;
mod files;
mod flips;
mod hostile;
mod order;
mod support;
