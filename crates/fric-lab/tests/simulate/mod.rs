mod compensated;
mod effects;
mod robots;
mod shapes;
mod stream;
mod trajectory;
