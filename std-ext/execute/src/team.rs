//! Ranks: processes without common memory that work on one run.
//!
//! Rank 0 runs the program, and [calls](Team::call) the others for parts of the work that they do together; they
//! [listen](Team::listen) until it dismisses them. No result depends on the number of ranks.

/// Numbers that are sent as their bytes.
pub use bytemuck::Pod;
use std::fmt::Debug;
use std::ops::Range;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

/// The way in which ranks exchange bytes. Messages between two ranks arrive in the order in which they were sent, and have
/// the lengths that the receiver expects.
pub trait Ranks: Debug + Send + Sync {
    /// The number of this rank, from 0 on.
    fn number(&self) -> usize;

    /// The number of ranks.
    fn count(&self) -> usize;

    /// Sends bytes to another rank; it may return only when they are received.
    fn send(&self, to: usize, bytes: &[u8]);

    /// Waits for bytes from another rank.
    fn receive(&self, from: usize, bytes: &mut [u8]);

    /// Sends to one rank and receives from one, in any order.
    fn exchange(&self, to: usize, sent: &[u8], from: usize, received: &mut [u8]);
}

/// All ranks, as one of them sees them.
#[derive(Clone, Debug, Default)]
pub struct Team {
    /// None where there is only one.
    ranks: Option<Arc<dyn Ranks>>,
}

impl Team {
    /// One rank.
    pub fn alone() -> Self {
        Self::default()
    }

    /// The team of these ranks.
    pub fn new(ranks: impl Ranks + 'static) -> Self {
        match ranks.count() {
            1 => Self::alone(),
            _ => Self {
                ranks: Some(Arc::new(ranks)),
            },
        }
    }

    /// The team of ranks that are threads of this process, as each of them sees it: for tests.
    pub fn of_threads(count: usize) -> Vec<Self> {
        let mut ends = Vec::from_iter((0..count).map(|_| (Vec::new(), Vec::new())));
        for from in 0..count {
            for to in 0..count {
                let (sender, receiver) = channel();
                ends[from].0.push(sender);
                ends[to].1.push(Mutex::new(receiver));
            }
        }
        let threads = ends.into_iter().enumerate();
        let threads = threads.map(|(number, (senders, receivers))| Channels {
            number,
            senders,
            receivers,
        });
        threads.map(Self::new).collect()
    }

    /// The number of this rank.
    pub fn number(&self) -> usize {
        self.ranks.as_ref().map_or(0, |ranks| ranks.number())
    }

    /// The number of ranks.
    pub fn count(&self) -> usize {
        self.ranks.as_ref().map_or(1, |ranks| ranks.count())
    }

    /// Whether there is only one rank.
    pub fn is_alone(&self) -> bool {
        self.ranks.is_none()
    }

    /// The rank after this one, and the one before it, in a circle.
    pub fn neighbours(&self) -> [usize; 2] {
        let (number, count) = (self.number(), self.count());
        [(number + 1) % count, (number + count - 1) % count]
    }

    /// Divides things into consecutive ranges, one for each rank, of sizes that differ by 1 at most.
    pub fn divide(&self, things: usize) -> Vec<Range<usize>> {
        let count = self.count();
        let start = |rank: usize| things * rank / count;
        (0..count)
            .map(|rank| start(rank)..start(rank + 1))
            .collect()
    }

    /// Sends numbers to one rank and receives numbers from one.
    pub fn exchange<N: Pod>(&self, to: usize, sent: &[N], from: usize, received: &mut [N]) {
        let (sent, received) = (
            bytemuck::cast_slice(sent),
            bytemuck::cast_slice_mut(received),
        );
        self.expect().exchange(to, sent, from, received);
    }

    /// Sends numbers to a rank, which [receives](Self::receive) them.
    pub fn send<N: Pod>(&self, to: usize, numbers: &[N]) {
        self.expect().send(to, bytemuck::cast_slice(numbers));
    }

    /// Receives numbers that a rank sends.
    pub fn receive<N: Pod>(&self, from: usize, numbers: &mut [N]) {
        (self.expect()).receive(from, bytemuck::cast_slice_mut(numbers));
    }

    /// Completes numbers of which each rank knows its part; parts are consecutive.
    ///
    /// # Panics
    /// If there is not one part for each rank, or a part is not in the numbers.
    pub fn gather<N: Pod>(&self, numbers: &mut [N], parts: &[Range<usize>]) {
        assert_eq!(parts.len(), self.count(), "one part for each rank");
        let [next, before] = self.neighbours();
        // Round the circle: each rank passes on the part that it has received last.
        let mut known = self.number();
        for _ in 1..self.count() {
            let coming = (known + self.count() - 1) % self.count();
            let [sent, received] = numbers
                .get_disjoint_mut([parts[known].clone(), parts[coming].clone()])
                .expect("parts follow one after the other");
            self.exchange(next, sent, before, received);
            known = coming;
        }
    }

    /// Whether something holds on all ranks.
    pub fn all(&self, own: bool) -> bool {
        if self.is_alone() {
            return own;
        }
        let mut known = vec![0_u8; self.count()];
        known[self.number()] = u8::from(own);
        self.gather(&mut known, &self.divide(self.count()));
        !known.contains(&0)
    }

    /// Sets numbers on all ranks to those on rank 0.
    pub fn broadcast<N: Pod>(&self, numbers: &mut [N]) {
        let (number, count) = (self.number(), self.count());
        // A tree: each rank has them from the one whose number lacks its lowest bit.
        let mut bit = 1;
        while bit < count && number & bit == 0 {
            bit *= 2;
        }
        if number > 0 {
            self.receive(number - bit, numbers);
        }
        while bit > 1 {
            bit /= 2;
            if number + bit < count {
                self.send(number + bit, numbers);
            }
        }
    }

    /// Calls the other ranks, as rank 0, with a message that is not empty.
    pub fn call(&self, message: &[u8]) {
        debug_assert!(self.number() == 0 && !message.is_empty());
        self.tell(message);
    }

    /// Dismisses the other ranks, as rank 0.
    pub fn dismiss(&self) {
        self.tell(&[]);
    }

    fn tell(&self, message: &[u8]) {
        if self.is_alone() {
            return;
        }
        self.broadcast(&mut [message.len() as u64]);
        self.broadcast(&mut message.to_vec());
    }

    /// Waits for a [call](Self::call) of rank 0; none if this rank is dismissed.
    pub fn listen(&self) -> Option<Vec<u8>> {
        if self.is_alone() {
            return None;
        }
        let mut length = [0_u64];
        self.broadcast(&mut length);
        let mut message = vec![0; length[0] as usize];
        self.broadcast(&mut message);
        Some(message).filter(|message| !message.is_empty())
    }

    fn expect(&self) -> &dyn Ranks {
        self.ranks.as_deref().expect("there are other ranks")
    }
}

/// Things, for example the vertices of surfaces, each of which belongs to one rank; those of a rank need not follow one after
/// the other.
#[derive(Clone, Debug)]
pub struct Division {
    team: Team,
    /// Ranges of things, those of one rank after those of another.
    pieces: Vec<Range<usize>>,
    /// The pieces of each rank.
    of_ranks: Vec<Range<usize>>,
    /// The things of each rank, if all were in the order of pieces.
    parts: Vec<Range<usize>>,
}

impl Division {
    /// A division of the things in these ranges, in their order for each rank.
    ///
    /// # Panics
    /// If there are not ranges for each rank.
    pub fn new(team: Team, ranges: Vec<Vec<Range<usize>>>) -> Self {
        assert_eq!(ranges.len(), team.count(), "ranges for each rank");
        let (mut pieces, mut of_ranks, mut parts) = (Vec::new(), Vec::new(), Vec::new());
        let mut start = 0;
        for ranges in ranges {
            let first = pieces.len();
            let count = ranges.iter().map(Range::len).sum::<usize>();
            pieces.extend(ranges);
            of_ranks.push(first..pieces.len());
            parts.push(start..start + count);
            start += count;
        }
        Self {
            team,
            pieces,
            of_ranks,
            parts,
        }
    }

    /// The division of one rank alone.
    pub fn alone() -> Self {
        Self::new(Team::alone(), vec![Vec::new()])
    }

    /// The ranks.
    pub fn team(&self) -> &Team {
        &self.team
    }

    /// Completes numbers of which each rank knows its own.
    pub fn gather<N: Pod>(&self, numbers: &mut [N]) {
        if self.team.is_alone() {
            return;
        }
        let number = self.team.number();
        let mut ordered = vec![N::zeroed(); self.parts.last().map_or(0, |part| part.end)];
        let mut own = &mut ordered[self.parts[number].clone()];
        for piece in &self.pieces[self.of_ranks[number].clone()] {
            let (first, rest) = own.split_at_mut(piece.len());
            first.copy_from_slice(&numbers[piece.clone()]);
            own = rest;
        }
        self.team.gather(&mut ordered, &self.parts);
        let mut ordered = ordered.as_slice();
        for piece in &self.pieces {
            let (first, rest) = ordered.split_at(piece.len());
            numbers[piece.clone()].copy_from_slice(first);
            ordered = rest;
        }
    }
}

/// Ranks that are threads of one process.
#[derive(Debug)]
struct Channels {
    number: usize,
    senders: Vec<Sender<Vec<u8>>>,
    receivers: Vec<Mutex<Receiver<Vec<u8>>>>,
}

impl Ranks for Channels {
    fn number(&self) -> usize {
        self.number
    }

    fn count(&self) -> usize {
        self.senders.len()
    }

    fn send(&self, to: usize, bytes: &[u8]) {
        let sent = self.senders[to].send(bytes.to_vec());
        sent.unwrap_or_else(|_| panic!("rank {to} has ended"));
    }

    fn receive(&self, from: usize, bytes: &mut [u8]) {
        let receiver = self.receivers[from].lock();
        let received = receiver.ok().and_then(|receiver| receiver.recv().ok());
        let received = received.unwrap_or_else(|| panic!("rank {from} has ended"));
        bytes.copy_from_slice(&received);
    }

    fn exchange(&self, to: usize, sent: &[u8], from: usize, received: &mut [u8]) {
        self.send(to, sent);
        self.receive(from, received);
    }
}
