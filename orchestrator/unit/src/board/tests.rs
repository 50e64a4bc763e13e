//! The board as its two processes use it, and as a crashed one leaves it.

use super::*;
use crate::failure::Doing;
use fmi2::calls::Call;
use std::os::unix::fs::PermissionsExt;
use std::thread;

const LAYOUT: BoardLayout = BoardLayout { notes: 2, columns: 3, claims: 2 };

/// A board in a file: the view of the process that created it, and the view of the one that opened it.
fn both_sides() -> (tempfile::TempDir, Board, Board) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("board");
    let parent = Board::create(&path, &LAYOUT).unwrap();
    let child = Board::open(&path).unwrap();
    (folder, parent, child)
}

fn write(board: &Board, tick: u64, slots: [u64; 3]) {
    board.write_row(tick, |row| slots.into_iter().enumerate().for_each(|(column, value)| row.set(column, value)));
}

#[test]
fn a_board_is_readable_by_its_owner_only_and_never_overwrites_a_file() {
    let (folder, parent, child) = both_sides();
    let path = folder.path().join("board");
    assert_eq!(path.metadata().unwrap().permissions().mode() & 0o777, 0o600);
    assert_eq!((parent.layout(), child.layout()), (&LAYOUT, &LAYOUT));
    assert_eq!(Board::create(&path, &LAYOUT).unwrap_err().kind(), io::ErrorKind::AlreadyExists);
}

#[test]
fn a_file_that_is_not_a_board_is_not_opened() {
    let (folder, _parent, child) = both_sides();
    let path = folder.path().join("board");
    child.word(COLUMNS_AT).store(1 << 62, Ordering::Relaxed);
    assert_eq!(Board::open(&path).unwrap_err().kind(), io::ErrorKind::InvalidData);
    std::fs::write(folder.path().join("text"), "a text that is longer than a header\n".repeat(10)).unwrap();
    assert!(Board::open(&folder.path().join("text")).unwrap_err().to_string().ends_with("text is no board"));
    std::fs::write(folder.path().join("empty"), "").unwrap();
    assert!(Board::open(&folder.path().join("empty")).is_err());
}

#[test]
fn a_layout_that_is_too_large_is_an_error() {
    for layout in [BoardLayout { columns: usize::MAX, ..LAYOUT }, BoardLayout { notes: usize::MAX / 8, ..LAYOUT }] {
        assert_eq!(Board::private(&layout).unwrap_err().kind(), io::ErrorKind::InvalidInput);
    }
}

#[test]
fn a_note_holds_the_call_in_progress_and_nothing_between_calls() {
    let (_folder, parent, child) = both_sides();
    let (writer, reader) = (child.note(1), parent.note(1));
    assert_eq!(reader.read(), None);
    let now = writer.at(7, 0.07);
    assert_eq!(reader.read(), None);
    now.call(4, Doing::Call(Call::SetReal), || ());
    now.call(300, Doing::Call(Call::DoStep), || ());
    let in_call = InCall { tick: 7, instance: 300, doing: Doing::Call(Call::DoStep), unwound: false, count: 1 };
    assert_eq!(reader.read(), Some(in_call));
    assert_eq!(parent.note(0).read(), None);
    drop(now);
    assert_eq!((reader.read(), reader.tick()), (None, 7));
    let now = writer.at(8, 0.08);
    now.call(0, Doing::Load, || ());
    assert_eq!(reader.read(), Some(InCall { tick: 8, instance: 0, doing: Doing::Load, unwound: false, count: 2 }));
}

#[test]
fn a_note_outlives_the_board_that_it_was_taken_from() {
    let note = Board::private(&LAYOUT).unwrap().note(0);
    let now = note.at(1, 0.01);
    now.call(2, Doing::Load, || ());
    assert_eq!(note.read().map(|in_call| in_call.instance), Some(2));
}

#[test]
fn rows_arrive_in_order_however_often_the_ring_wraps_around() {
    let (_folder, parent, child) = both_sides();
    let rows = 5 * parent.offsets.row_capacity as u64 + 3;
    thread::scope(|scope| {
        scope.spawn(|| (0..rows).for_each(|tick| write(&child, tick, [tick, !tick, tick * 3])));
        let mut next = 0;
        while next < rows {
            parent.pop_rows(|tick, slots| {
                assert_eq!((tick, slots), (next, [tick, !tick, tick * 3].as_slice()));
                next += 1;
            });
        }
    });
    assert_eq!(parent.pop_rows(|_, _| unreachable!("all rows were read")), 0);
}

#[test]
fn a_row_whose_writer_panics_is_not_published_and_the_next_one_is() {
    let (_folder, parent, child) = both_sides();
    write(&child, 1, [2, 3, 4]);
    let half_written =
        || child.write_row(2, |row| [0, LAYOUT.columns].into_iter().for_each(|column| row.set(column, 7)));
    assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(half_written)).is_err());
    write(&child, 3, [4, 5, 6]);
    let mut rows = Vec::new();
    parent.pop_rows(|tick, slots| rows.push((tick, slots.to_vec())));
    assert_eq!(rows, [(1, vec![2, 3, 4]), (3, vec![4, 5, 6])]);
}

#[test]
fn messages_of_several_threads_arrive_whole() {
    let (_folder, parent, child) = both_sides();
    const THREADS: u8 = 3;
    const EACH: usize = 400;
    let mut received = Vec::new();
    thread::scope(|scope| {
        for thread in 0..THREADS {
            let child = &child;
            scope.spawn(move || {
                for i in 0..EACH {
                    assert!(child.push_message(&vec![thread; i * 17 % 9000]));
                }
            });
        }
        while received.len() < EACH * usize::from(THREADS) {
            parent.pop_messages(|message| received.push(message.to_vec()));
        }
    });
    for thread in 1..THREADS {
        let of_thread = |message: &&Vec<u8>| message.first() == Some(&thread);
        assert!(received.iter().filter(of_thread).all(|message| message.iter().all(|&byte| byte == thread)));
        let lengths: Vec<_> = received.iter().filter(of_thread).map(Vec::len).collect();
        let expected: Vec<_> = (0..EACH).map(|i| i * 17 % 9000).filter(|&length| length > 0).collect();
        assert_eq!(lengths, expected);
    }
}

#[test]
fn a_message_that_is_longer_than_the_ring_is_refused_and_the_longest_that_fits_passes() {
    let (_folder, parent, child) = both_sides();
    assert!(!child.push_message(&vec![1; Board::LONGEST_MESSAGE + 1]));
    for round in 0..3 {
        assert!(child.push_message(&vec![round; Board::LONGEST_MESSAGE]));
        let mut length = 0;
        assert_eq!(parent.pop_messages(|message| length = message.len()), 1);
        assert_eq!(length, Board::LONGEST_MESSAGE);
    }
}

#[test]
fn a_claim_is_read_as_it_was_last_stored_even_if_its_writer_died_while_storing_the_next() {
    let (_folder, parent, child) = both_sides();
    assert_eq!(parent.claim(1), None);
    let first = ClaimNote { verdict: 1, margin: -0.25, worst_tick: 40, first_tick: 38, part: 2 };
    child.set_claim(1, &first);
    assert_eq!(parent.claim(1), Some(first));
    let second = ClaimNote { verdict: 2, margin: f64::INFINITY, ..first };
    child.set_claim(1, &second);
    assert_eq!(parent.claim(1), Some(second));
    // A third is half written, over the copy that held the first.
    for word in &child.claim_words(1)[10..13] {
        word.store(77, Ordering::Relaxed);
    }
    assert_eq!((parent.claim(0), parent.claim(1)), (None, Some(second)));
}

#[test]
fn the_stop_flag_and_the_tick_reach_the_other_side() {
    let (_folder, parent, child) = both_sides();
    assert!(!child.stop_requested());
    parent.request_stop();
    child.set_tick(12);
    assert!(child.stop_requested());
    assert_eq!(parent.tick(), 12);
}

proptest::proptest! {
    #[test]
    fn a_reader_survives_any_overwritten_words_of_a_board(
        overwritten in proptest::collection::vec((0_usize..4096, 0_u64..), 1..40),
        near_the_rings in proptest::collection::vec((0_usize..24, proptest::bool::ANY, 0_u64..200_000), 0..8),
    ) {
        let (_folder, parent, child) = both_sides();
        child.push_message(b"before");
        write(&child, 1, [2, 3, 4]);
        for (at, value) in overwritten {
            child.word(at).store(value, Ordering::Relaxed);
        }
        for (at, of_messages, value) in near_the_rings {
            let start = if of_messages { child.offsets.messages } else { child.offsets.rows };
            child.word(start + at).store(value, Ordering::Relaxed);
        }
        for _ in 0..2 {
            let rows = parent.pop_rows(|_, slots| assert_eq!(slots.len(), LAYOUT.columns));
            assert!(rows <= parent.offsets.row_capacity);
            parent.pop_messages(|message| assert!(message.len() <= Board::LONGEST_MESSAGE));
            let _ = (parent.note(0).read(), parent.claim(0), parent.tick());
        }
    }
}
