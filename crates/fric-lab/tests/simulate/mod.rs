mod compensated;
mod effects;
mod idle;
pub mod robots;
mod shapes;
mod stream;
mod sweep;
mod truths;
