//! Messages are decoded as they were encoded, and invalid bytes are rejected without a panic.

use super::*;
use flatten::wiring::VariableRange;
use proptest::prelude::*;

/// The ports of an instance with so many variables of each type, whose values begin at index 1.
fn ports(counts: [usize; 4]) -> Ports {
    let [reals, integers, booleans, texts] = counts.map(|count| VariableRange { start: 1, variables: vec![0; count] });
    Ports { reals, integers, booleans, texts }
}

/// Values with one more before and behind them, which no message may read or change.
fn surrounded<T: Clone>(values: &[T], other: T) -> Vec<T> {
    std::iter::once(other.clone()).chain(values.iter().cloned()).chain([other]).collect()
}

fn any_values() -> impl Strategy<Value = Values> {
    let bits = prop::collection::vec(any::<u64>(), 0..5);
    let texts = prop::collection::vec(".{0,9}", 0..4);
    (bits, prop::collection::vec(any::<i32>(), 0..5), prop::collection::vec(0..2_i32, 0..9), texts).prop_map(
        |(bits, integers, booleans, texts)| Values {
            reals: bits.into_iter().map(f64::from_bits).collect(),
            integers,
            booleans,
            texts,
        },
    )
}

fn header() -> Header {
    Header { kind: Kind::Stepped, group: 3, schema: 0x1234_5678_9abc_def0, sequence: 7, tick: u64::MAX }
}

fn bits(values: &Values) -> (Vec<u64>, &[i32], &[i32], &[String]) {
    let reals = values.reals.iter().map(|value| value.to_bits()).collect();
    (reals, &values.integers, &values.booleans, &values.texts)
}

proptest! {
    #[test]
    fn encoded_values_are_decoded_to_the_same_bits(all in prop::collection::vec(any_values(), 0..4), extras: Vec<u8>) {
        let mut outgoing = Outgoing::new(&header());
        let ports_of = |values: &Values| {
            ports([values.reals.len(), values.integers.len(), values.booleans.len(), values.texts.len()])
        };
        let placed = |values: &Values| Values {
            reals: surrounded(&values.reals, 0.5),
            integers: surrounded(&values.integers, 5),
            booleans: surrounded(&values.booleans, 1),
            texts: surrounded(&values.texts, "other".to_owned()),
        };
        for (instance, values) in all.iter().enumerate() {
            outgoing.block(instance, &ports_of(values), &placed(values));
        }
        let bytes = outgoing.finish(&extras);
        let mut incoming = Incoming::read(&bytes).unwrap();
        prop_assert_eq!((incoming.header, incoming.extras), (header(), extras.as_slice()));
        for (instance, values) in all.iter().enumerate() {
            let blank = Values {
                reals: vec![0.0; values.reals.len()],
                integers: vec![0; values.integers.len()],
                booleans: vec![0; values.booleans.len()],
                texts: vec![String::new(); values.texts.len()],
            };
            let mut decoded = placed(&blank);
            incoming.blocks.read(instance, &ports_of(values), &mut decoded).unwrap();
            let encoded = placed(values);
            prop_assert_eq!(bits(&decoded), bits(&encoded));
        }
        prop_assert_eq!(incoming.blocks.end(), Ok(()));
    }

    #[test]
    fn any_bytes_are_decoded_without_a_panic(
        mut bytes in prop::collection::vec(any::<u8>(), 0..200), starts_like_ours: bool, counts: [u8; 4],
    ) {
        if starts_like_ours && bytes.len() >= 6 {
            bytes[..4].copy_from_slice(&MAGIC.to_le_bytes());
            bytes[4..6].copy_from_slice(&(Kind::Stepped as u16).to_le_bytes());
        }
        is_valid(&bytes, counts.map(|count| usize::from(count % 4)));
    }

    #[test]
    fn a_message_with_any_byte_changed_is_decoded_without_a_panic(
        values in any_values(), at: prop::sample::Index, to: u8, cut: prop::sample::Index,
    ) {
        let counts = [values.reals.len(), values.integers.len(), values.booleans.len(), values.texts.len()];
        let mut outgoing = Outgoing::new(&header());
        let placed = Values {
            reals: surrounded(&values.reals, 0.5),
            integers: surrounded(&values.integers, 5),
            booleans: surrounded(&values.booleans, 1),
            texts: surrounded(&values.texts, String::new()),
        };
        outgoing.block(0, &ports(counts), &placed);
        let mut bytes = outgoing.finish(b"extras");
        prop_assert!(!is_valid(&bytes[..cut.index(bytes.len())], counts), "a truncated message is rejected");
        let at = at.index(bytes.len());
        bytes[at] = to;
        is_valid(&bytes, counts);
    }
}

/// Decodes bytes as the reply of a worker; whether they are valid.
fn is_valid(bytes: &[u8], counts: [usize; 4]) -> bool {
    let Ok(mut incoming) = Incoming::read(bytes) else { return false };
    let mut values = Values {
        reals: vec![0.0; counts[0] + 2],
        integers: vec![0; counts[1] + 2],
        booleans: vec![0; counts[2] + 2],
        texts: vec![String::new(); counts[3] + 2],
    };
    incoming.blocks.read(0, &ports(counts), &mut values).and_then(|()| incoming.blocks.end()).is_ok()
}

#[test]
fn each_defect_of_a_message_has_its_own_error() {
    let (reals, booleans) = (vec![0.0, 1.5, 0.0], vec![0, 1, 0]);
    let values = Values { reals, integers: vec![0], booleans, texts: vec![String::new()] };
    let encode = |ports: Ports| {
        let mut outgoing = Outgoing::new(&header());
        outgoing.block(2, &ports, &values);
        outgoing.finish(b"")
    };
    let good = encode(ports([1, 0, 1, 0]));
    let read = |bytes: &[u8], instance: usize, counts: [usize; 4]| {
        let mut incoming = Incoming::read(bytes)?;
        let mut values = values.clone();
        incoming.blocks.read(instance, &ports(counts), &mut values)?;
        incoming.blocks.end()
    };
    let changed = |at: usize, to: u8| {
        let mut bytes = good.clone();
        bytes[at] = to;
        bytes
    };
    assert_eq!(read(&good, 2, [1, 0, 1, 0]), Ok(()));
    assert_eq!(read(&good, 1, [1, 0, 1, 0]), Err(Malformed::Instance { expected: 1, found: Some(2) }));
    assert_eq!(read(&good, 2, [1, 0, 0, 0]), Err(Malformed::Counts(2)));
    assert_eq!(read(&changed(0, b'X'), 2, [1, 0, 1, 0]), Err(Malformed::Foreign));
    assert_eq!(read(&changed(4, 99), 2, [1, 0, 1, 0]), Err(Malformed::Kind(99)));
    assert_eq!(read(&changed(BLOCKS_AT, 0), 2, [1, 0, 1, 0]), Err(Malformed::Instance { expected: 2, found: None }));
    assert_eq!(read(&changed(BLOCKS_AT, 2), 2, [1, 0, 1, 0]), Err(Malformed::LeftOver));
    assert_eq!(read(&changed(HEADER_BYTES + 4, 9), 2, [1, 0, 1, 0]), Err(Malformed::Reserved(9)));
    assert_eq!(read(&changed(HEADER_BYTES + 32, 2), 2, [1, 0, 1, 0]), Err(Malformed::Boolean(2)));
    assert_eq!(read(&changed(HEADER_BYTES + 33, 1), 2, [1, 0, 1, 0]), Err(Malformed::LeftOver));
    assert_eq!(read(&good[..HEADER_BYTES - 1], 2, [1, 0, 1, 0]), Err(Malformed::Short));
}

#[test]
fn the_number_of_a_reply_is_that_of_its_order_plus_sixteen() {
    for (order, reply) in Kind::ORDERS {
        assert_eq!((order.reply(), reply as u16), (Some(reply), order as u16 + 16));
        assert_eq!(reply.reply(), None);
    }
}
