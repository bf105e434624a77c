//! Every piece of work alone, on pictures and sounds made in code, with its allocations.

use divan::Bencher;
use hearsight_benches::{Inputs, Kernel, Topic};

#[global_allocator]
static ALLOCATIONS: divan::AllocProfiler = divan::AllocProfiler::system();

fn main() {
    divan::main();
}

#[divan::bench(args = Kernel::names(Topic::Pictures))]
fn pictures(bencher: Bencher<'_, '_>, name: &str) {
    run(bencher, name);
}

#[divan::bench(args = Kernel::names(Topic::Faces))]
fn faces(bencher: Bencher<'_, '_>, name: &str) {
    run(bencher, name);
}

#[divan::bench(args = Kernel::names(Topic::Sounds))]
fn sounds(bencher: Bencher<'_, '_>, name: &str) {
    run(bencher, name);
}

#[divan::bench(args = Kernel::names(Topic::Rooms))]
fn rooms(bencher: Bencher<'_, '_>, name: &str) {
    run(bencher, name);
}

#[divan::bench(args = Kernel::names(Topic::States))]
fn states(bencher: Bencher<'_, '_>, name: &str) {
    run(bencher, name);
}

fn run(bencher: Bencher<'_, '_>, name: &str) {
    let Some(kernel) = Kernel::named(name) else { return };
    match kernel.prepare(&Inputs::synthetic()) {
        Ok(mut work) => bencher.bench_local(&mut work),
        Err(reason) => eprintln!("{name} is skipped: {reason}"),
    }
}
