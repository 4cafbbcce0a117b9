//! Pictures for [`helfrich`]: surfaces coloured by a field, sections and plots, as PNG files.

pub mod picture;
