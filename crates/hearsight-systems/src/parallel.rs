//! Runs the views of a system side by side: they share nothing, so the number of threads changes no result.

use rayon::prelude::*;

/// Calls `work` on every view and returns the first error in the order of the views.
pub(crate) fn each<View: Send, Error: Send>(
    views: &mut [View],
    work: impl Fn(&mut View) -> Result<(), Error> + Sync + Send,
) -> Result<(), Error> {
    if let [view] = views {
        return work(view);
    }
    let outcomes: Vec<Result<(), Error>> = views.par_iter_mut().map(work).collect();
    outcomes.into_iter().collect()
}
