mod compensated;
mod effects;
pub mod robots;
mod shapes;
mod stream;
mod sweep;
mod truths;
