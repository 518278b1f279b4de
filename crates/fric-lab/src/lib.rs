//! fric-lab
