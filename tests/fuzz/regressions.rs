//! Files that did harm once, and what is said of them now.
