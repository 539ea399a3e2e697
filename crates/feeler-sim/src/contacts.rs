//! The contacts of one finger, as columns of numbers: what happens to many contacts alike is computed side by side.
//!
//! A loop over the numbers of a block has no branches where all feelers are alike and are nothing but springs, so that the
//! compiler makes instructions of it that work on four contacts at once (AVX2). It calls the very functions that work on a
//! single contact, and adds up in the same order: results do not depend on the processor, to the bit.

use super::columnar_feeler::Anchor;
use super::state::Contact;
use glam::DVec3;

/// Contacts of a block: a cache line of each number.
pub(super) const BLOCK: usize = 8;

/// Contacts that are worked on at once; a block's last ones are filled up to as many.
const LANES: usize = 4;

/// A number of each contact of a block.
pub(super) type Column = [f64; BLOCK];

/// A vector of each contact of a block.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Vectors {
    x: Column,
    y: Column,
    z: Column,
}

impl Vectors {
    #[inline(always)]
    pub fn get(&self, lane: usize) -> DVec3 {
        DVec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    #[inline(always)]
    pub fn set(&mut self, lane: usize, vector: DVec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (vector.x, vector.y, vector.z);
    }
}

/// Up to [`BLOCK`] contacts on one object.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
pub(super) struct Block {
    element: [usize; BLOCK],
    /// The feelers' axes in the fingertip frame `T`.
    axis: Vectors,
    anchor: Vectors,
    normal: Vectors,
    rolled: Column,
    tip_before: Vectors,
}

impl Block {
    #[inline(always)]
    pub fn element(&self, lane: usize) -> usize {
        self.element[lane]
    }

    #[inline(always)]
    pub fn axis(&self, lane: usize) -> DVec3 {
        self.axis.get(lane)
    }

    #[inline(always)]
    pub fn anchor(&self, lane: usize) -> Anchor {
        Anchor {
            position: self.anchor.get(lane),
            normal: self.normal.get(lane),
        }
    }

    #[inline(always)]
    pub fn set_anchor(&mut self, lane: usize, anchor: &Anchor) {
        self.anchor.set(lane, anchor.position);
        self.normal.set(lane, anchor.normal);
    }

    /// Moves an anchor whose normal stays.
    #[inline(always)]
    pub fn move_anchor(&mut self, lane: usize, position: DVec3) {
        self.anchor.set(lane, position);
    }

    /// Moves all anchors, whose normals stay, as tips have rolled by `distance`, m.
    #[inline(always)]
    pub fn roll_to(&mut self, anchors: &Vectors, distance: f64) {
        self.anchor = *anchors;
        for rolled in &mut self.rolled {
            *rolled += distance;
        }
    }

    #[inline(always)]
    pub fn rolled(&self, lane: usize) -> f64 {
        self.rolled[lane]
    }

    #[inline(always)]
    pub fn set_rolled(&mut self, lane: usize, rolled: f64) {
        self.rolled[lane] = rolled;
    }

    #[inline(always)]
    pub fn tip_before(&self, lane: usize) -> DVec3 {
        self.tip_before.get(lane)
    }

    #[inline(always)]
    pub fn set_tip_before(&mut self, lane: usize, position: DVec3) {
        self.tip_before.set(lane, position);
    }

    fn copy_lane(&mut self, to: usize, other: &Self, from: usize) {
        self.element[to] = other.element[from];
        self.axis.set(to, other.axis.get(from));
        self.set_anchor(to, &other.anchor(from));
        self.rolled[to] = other.rolled[from];
        self.tip_before.set(to, other.tip_before.get(from));
    }
}

/// A block's share of the contacts on an object.
#[derive(Debug, Clone, Copy)]
pub(super) struct Share {
    /// Its contacts.
    pub count: usize,
    /// The same, filled up to whole groups of lanes. What stands in the others means nothing.
    pub lanes: usize,
}

impl Share {
    /// What block number `block` has of `count` contacts.
    fn of(count: usize, block: usize) -> Self {
        let count = (count - BLOCK * block).min(BLOCK);
        Self {
            count,
            lanes: count.next_multiple_of(LANES).min(BLOCK),
        }
    }
}

/// The contacts on one object, in the order in which they began.
#[derive(Debug, Clone)]
pub(super) struct OnObject {
    count: usize,
    blocks: Vec<Block>,
}

impl OnObject {
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The blocks that have contacts.
    pub fn blocks(&self) -> impl Iterator<Item = (Share, &Block)> {
        let used = self.count.div_ceil(BLOCK);
        let blocks = self.blocks[..used].iter().enumerate();
        blocks.map(|(index, block)| (Share::of(self.count, index), block))
    }

    /// The same, to change them.
    pub fn blocks_mut(&mut self) -> impl Iterator<Item = (Share, &mut Block)> {
        let count = self.count;
        let used = count.div_ceil(BLOCK);
        let blocks = self.blocks[..used].iter_mut().enumerate();
        blocks.map(move |(index, block)| (Share::of(count, index), block))
    }

    /// Takes away the contacts of elements of which `keeps` says no; the others stay in order.
    pub fn retain(&mut self, keeps: impl Fn(usize) -> bool) {
        let mut kept = 0;
        for index in 0..self.count {
            let from = self.blocks[index / BLOCK];
            let lane = index % BLOCK;
            if keeps(from.element[lane]) {
                if kept != index {
                    self.blocks[kept / BLOCK].copy_lane(kept % BLOCK, &from, lane);
                }
                kept += 1;
            }
        }
        self.count = kept;
    }
}

/// The feelers of a finger that touch.
#[derive(Debug, Clone)]
pub struct Contacts {
    objects: Vec<OnObject>,
}

impl Contacts {
    /// None yet, of a finger with so many `elements`, in a world of so many `objects`.
    pub(super) fn none(objects: usize, elements: usize) -> Self {
        let nothing = OnObject {
            count: 0,
            blocks: vec![Block::default(); elements.div_ceil(BLOCK)],
        };
        Self {
            objects: vec![nothing; objects],
        }
    }

    /// Whether none touches.
    pub fn is_empty(&self) -> bool {
        self.objects.iter().all(OnObject::is_empty)
    }

    /// How many touch.
    pub fn len(&self) -> usize {
        self.objects.iter().map(|object| object.count).sum()
    }

    /// The contacts: object after object, on each in the order in which they began.
    pub fn iter(&self) -> impl Iterator<Item = Contact> {
        let objects = self.objects.iter().enumerate();
        objects.flat_map(|(object, on)| {
            on.blocks().flat_map(move |(share, block)| {
                (0..share.count).map(move |lane| Contact {
                    element: block.element(lane),
                    object,
                    anchor: block.anchor(lane),
                    rolled: block.rolled(lane),
                    tip_before: block.tip_before(lane),
                })
            })
        })
    }

    /// The elements that touch, in the same order.
    pub(super) fn elements(&self) -> impl Iterator<Item = usize> + '_ {
        let blocks = self.objects.iter().flat_map(OnObject::blocks);
        blocks.flat_map(|(share, block)| (0..share.count).map(|lane| block.element(lane)))
    }

    /// Those on one object.
    pub(super) fn on(&self, object: usize) -> &OnObject {
        &self.objects[object]
    }

    /// The same, to change them.
    pub(super) fn on_mut(&mut self, object: usize) -> &mut OnObject {
        &mut self.objects[object]
    }

    /// Adds the contact of a feeler whose axis in `T` is `axis`. There is room for one of each element.
    pub(super) fn push(&mut self, contact: &Contact, axis: DVec3) {
        let on = &mut self.objects[contact.object];
        let (block, lane) = (on.count / BLOCK, on.count % BLOCK);
        let block = &mut on.blocks[block];
        block.element[lane] = contact.element;
        block.axis.set(lane, axis);
        block.set_anchor(lane, &contact.anchor);
        block.rolled[lane] = contact.rolled;
        block.tip_before.set(lane, contact.tip_before);
        on.count += 1;
    }
}

impl PartialEq for Contacts {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}
