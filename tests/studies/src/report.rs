//! Presentation of results without computation: tables, Markdown, and parts of the page of a study.

mod costs;
mod effects;
mod flow;
mod section;
mod stability;

pub use costs::cost_table;
pub use effects::effect_table;
pub use flow::flow_tables;
pub use section::page_section;
pub use stability::{stability_markdown, stability_table};
