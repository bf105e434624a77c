//! The commands, one file each.

pub(crate) mod calibrate;
pub(crate) mod check;
pub(crate) mod demo;
pub(crate) mod evaluate;
pub(crate) mod reproduce;
pub(crate) mod schema;
pub(crate) mod simulate;
pub(crate) mod track;
