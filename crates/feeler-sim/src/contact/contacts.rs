//! The contacts of one finger in structure-of-arrays form, for vectorized computation.
//!
//! If all feelers are identical pure springs, loops over a block have no branches and compile to SIMD instructions for
//! four contacts (AVX2). They call the same functions as the computation of a single contact and sum in the same
//! order, so results are bit-identical on all processors.

use super::columnar_feeler::Anchor;
use glam::DVec3;

/// A feeler in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Index of its element.
    pub element: usize,
    /// Index of the object.
    pub object: usize,
    /// Point where the feeler sticks to the object.
    pub anchor: Anchor,
    /// Rolling distance since the anchor was last projected onto the surface (m).
    pub rolled: f64,
    /// Centre of the undeformed tip in the object's frame, one step ago (m).
    pub tip_before: DVec3,
}

/// Number of contacts in a block: one cache line of `f64`.
pub(crate) const BLOCK: usize = 8;

/// Number of SIMD lanes; the used part of a block is padded to a multiple of it.
const LANES: usize = 4;

/// One number per contact of a block.
pub(crate) type Column = [f64; BLOCK];

/// One vector per contact of a block.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Vectors {
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
pub(crate) struct Block {
    /// Indices of the elements.
    pub element: [usize; BLOCK],
    /// Axes of the feelers in the fingertip frame `T`.
    pub axis: Vectors,
    /// Positions of the anchors.
    pub anchor: Vectors,
    /// Normals of the anchors.
    normal: Vectors,
    /// See [`Contact::rolled`].
    pub rolled: Column,
    /// See [`Contact::tip_before`].
    pub tip_before: Vectors,
}

impl Block {
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

    /// Sets the positions of all anchors, whose tips have rolled by another `distance` (m), and keeps their normals.
    #[inline(always)]
    pub fn roll_to(&mut self, anchors: &Vectors, distance: f64) {
        self.anchor = *anchors;
        for rolled in &mut self.rolled {
            *rolled += distance;
        }
    }

    fn copy_lane(&mut self, to: usize, other: &Self, from: usize) {
        self.element[to] = other.element[from];
        self.axis.set(to, other.axis.get(from));
        self.set_anchor(to, &other.anchor(from));
        self.rolled[to] = other.rolled[from];
        self.tip_before.set(to, other.tip_before.get(from));
    }
}

/// Used part of a block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Share {
    /// Number of contacts.
    pub count: usize,
    /// Number of contacts, padded to a multiple of the SIMD lanes. Values of the padding are meaningless.
    pub lanes: usize,
}

impl Share {
    /// Returns the used part of block number `block` of `count` contacts in total.
    fn of(count: usize, block: usize) -> Self {
        let count = (count - BLOCK * block).min(BLOCK);
        Self {
            count,
            lanes: count.next_multiple_of(LANES).min(BLOCK),
        }
    }
}

/// Contacts with one object, in the order in which they began.
#[derive(Debug, Clone)]
pub(crate) struct OnObject {
    count: usize,
    blocks: Vec<Block>,
}

impl OnObject {
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Blocks that contain contacts.
    pub fn blocks(&self) -> impl Iterator<Item = (Share, &Block)> {
        let used = self.count.div_ceil(BLOCK);
        let blocks = self.blocks[..used].iter().enumerate();
        blocks.map(|(index, block)| (Share::of(self.count, index), block))
    }

    /// Blocks that contain contacts, mutable.
    pub fn blocks_mut(&mut self) -> impl Iterator<Item = (Share, &mut Block)> {
        let count = self.count;
        let used = count.div_ceil(BLOCK);
        let blocks = self.blocks[..used].iter_mut().enumerate();
        blocks.map(move |(index, block)| (Share::of(count, index), block))
    }

    /// Keeps only contacts whose element satisfies `keeps`, in order.
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

/// Contacts of the feelers of one finger.
#[derive(Debug, Clone)]
pub struct Contacts {
    objects: Vec<OnObject>,
}

impl Contacts {
    /// Creates an empty collection for a world with this number of `objects` and a finger with this number of
    /// `elements`.
    pub(crate) fn none(objects: usize, elements: usize) -> Self {
        let nothing = OnObject {
            count: 0,
            blocks: vec![Block::default(); elements.div_ceil(BLOCK)],
        };
        Self {
            objects: vec![nothing; objects],
        }
    }

    /// Returns `true` if no feeler touches.
    pub fn is_empty(&self) -> bool {
        self.objects.iter().all(OnObject::is_empty)
    }

    /// Number of feelers in contact.
    pub fn len(&self) -> usize {
        self.objects.iter().map(|object| object.count).sum()
    }

    /// Iterates over the contacts by object, for each object in the order in which they began.
    pub fn iter(&self) -> impl Iterator<Item = Contact> {
        let objects = self.objects.iter().enumerate();
        objects.flat_map(|(object, on)| {
            on.blocks().flat_map(move |(share, block)| {
                (0..share.count).map(move |lane| Contact {
                    element: block.element[lane],
                    object,
                    anchor: block.anchor(lane),
                    rolled: block.rolled[lane],
                    tip_before: block.tip_before.get(lane),
                })
            })
        })
    }

    /// Elements in contact, in the order of [`iter`](Self::iter).
    pub(crate) fn elements(&self) -> impl Iterator<Item = usize> + '_ {
        let blocks = self.objects.iter().flat_map(OnObject::blocks);
        blocks.flat_map(|(share, block)| (0..share.count).map(|lane| block.element[lane]))
    }

    /// Contacts with one object.
    pub(crate) fn on(&self, object: usize) -> &OnObject {
        &self.objects[object]
    }

    /// Contacts with one object, mutable.
    pub(crate) fn on_mut(&mut self, object: usize) -> &mut OnObject {
        &mut self.objects[object]
    }

    /// Adds the contact of a feeler whose axis in `T` is `axis`. The capacity is one contact per element.
    pub(crate) fn push(&mut self, contact: &Contact, axis: DVec3) {
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
