//! The parts of the command, a client of the library: its arguments, its messages and the files that it keeps.

pub mod catalog;
pub mod cli;
pub mod diff;
mod error_text;
pub mod events;
mod frames;
pub mod info;
mod manual;
pub mod merge;
pub mod messages;
mod openjd;
pub mod outputs;
pub mod progress;
pub mod saving;
pub mod signals;
mod stdout;
mod suggestions;
pub mod view;
