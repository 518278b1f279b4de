mod logs;
mod oracle;
mod simulated;
mod unfit;
