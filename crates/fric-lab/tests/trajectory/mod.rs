mod crossing;
mod identification;
