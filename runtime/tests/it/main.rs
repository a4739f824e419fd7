//! Every test of the controllers: one program, linked once.

mod common;

mod attitude;
mod compression;
mod lei2022;
mod local_rules;
mod membership;
mod repeat;
mod saturation;
mod trigger;
mod wu2018;
mod xu2020;
mod yang2025;
mod yang2025_parts;
