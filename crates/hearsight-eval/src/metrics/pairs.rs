//! A number for each pair of a person and a track that ever meet, without a place for those that never do.

/// Numbers the pairs that were asked for.
#[derive(Debug)]
pub(super) struct PairNumbers {
    /// Of each person, the tracks by ascending index, each with its number.
    of_person: Vec<Vec<(u32, u32)>>,
    count: u32,
}

impl PairNumbers {
    pub(super) fn new(people: usize) -> Self {
        Self {
            of_person: vec![Vec::new(); people],
            count: 0,
        }
    }

    /// The number of a pair; a new one where it was never asked for.
    pub(super) fn number(&mut self, person: u32, track: u32) -> usize {
        let tracks = &mut self.of_person[person as usize];
        match tracks.binary_search_by_key(&track, |&(track, _)| track) {
            Ok(place) => tracks[place].1 as usize,
            Err(place) => {
                tracks.insert(place, (track, self.count));
                self.count += 1;
                self.count as usize - 1
            }
        }
    }

    /// The number of a pair that was asked for before.
    pub(super) fn known(&self, person: u32, track: u32) -> Option<usize> {
        let tracks = &self.of_person[person as usize];
        let place = tracks.binary_search_by_key(&track, |&(track, _)| track).ok()?;
        Some(tracks[place].1 as usize)
    }

    /// Person, track and number of every pair, by person and track.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, u32, usize)> + '_ {
        self.of_person.iter().enumerate().flat_map(|(person, tracks)| {
            tracks
                .iter()
                .map(move |&(track, number)| (person as u32, track, number as usize))
        })
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.count as usize
    }
}
