mod compensated;
mod effects;
mod robots;
mod stream;
mod trajectory;
