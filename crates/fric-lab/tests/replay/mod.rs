mod any_compensator;
mod columns;
