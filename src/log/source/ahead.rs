//! Reading ahead: what takes time to unpack is unpacked by a second thread while the first looks at what is there.

use std::io::{self, Read};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

/// A piece that is handed over \[bytes\], and how many may wait.
const PIECE: usize = 1 << 16;
const WAITING: usize = 4;

/// Gives `take` a reader of what `input` gives, which another thread reads a few pieces ahead.
pub(super) fn ahead<R>(input: &mut (dyn Read + Send), take: impl FnOnce(&mut (dyn Read + Send)) -> R) -> R {
    thread::scope(|scope| {
        let (send, pieces) = sync_channel(WAITING);
        scope.spawn(move || pump(input, &send));
        take(&mut Pieces { pieces, piece: Vec::new(), at: 0 })
    })
}

/// Hands over pieces until there are no more, one cannot be read, or nobody wants them.
fn pump(input: &mut (dyn Read + Send), send: &SyncSender<io::Result<Vec<u8>>>) {
    loop {
        let mut piece = Vec::with_capacity(PIECE);
        let read = input.take(PIECE as u64).read_to_end(&mut piece);
        let is_last = !matches!(read, Ok(PIECE));
        if send.send(read.map(|_| piece)).is_err() || is_last {
            return;
        }
    }
}

struct Pieces {
    pieces: Receiver<io::Result<Vec<u8>>>,
    piece: Vec<u8>,
    at: usize,
}

impl Read for Pieces {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        while self.at == self.piece.len() {
            // A sender that has gone has sent all.
            let Ok(piece) = self.pieces.recv() else { return Ok(0) };
            (self.piece, self.at) = (piece?, 0);
            if self.piece.is_empty() {
                return Ok(0);
            }
        }
        let count = into.len().min(self.piece.len() - self.at);
        into[..count].copy_from_slice(&self.piece[self.at..self.at + count]);
        self.at += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Breaks(usize);

    impl Read for Breaks {
        fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
            let count = into.len().min(self.0);
            self.0 -= count;
            into[..count].fill(7);
            if count == 0 { Err(io::Error::other("broken")) } else { Ok(count) }
        }
    }

    #[test]
    fn all_of_it_comes_through_in_order() {
        let bytes: Vec<u8> = (0..500_000_u32).map(|k| (k % 251) as u8).collect();
        let mut read = Vec::new();
        ahead(&mut &bytes[..], |input| input.read_to_end(&mut read)).unwrap();
        assert_eq!(read, bytes);
    }

    #[test]
    fn errors_come_through_and_a_reader_may_leave() {
        let mut read = Vec::new();
        let failed = ahead(&mut Breaks(100_000), |input| input.read_to_end(&mut read)).unwrap_err();
        assert_eq!((failed.to_string().as_str(), read.len()), ("broken", PIECE));
        let mut four = [0; 4];
        ahead(&mut Breaks(usize::MAX), |input| input.read_exact(&mut four)).unwrap();
        assert_eq!(four, [7; 4]);
    }
}
