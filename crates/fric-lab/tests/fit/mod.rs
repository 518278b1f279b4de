//! Identification against robots whose friction is known.

mod coverage;
mod delicate;
mod effects;
mod faulty;
mod jacobian;
mod logs;
mod oracle;
mod published;
mod together;
mod undetermined;
