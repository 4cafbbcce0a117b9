//! Pictures for [`helfrich`]: surfaces coloured by a field, sections and plots; with
//! the feature `png` as PNG files.

pub mod picture;
