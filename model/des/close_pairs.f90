!> Of the listed pairs those that may touch soon, and the slips of those that touch.
!>
!> Most of the listed pairs do not touch for many steps. So the pairs nearer than a small gap are chosen for some steps, in the
!> order of the list. Where parcels are slow nearly all of these touch: they are `tight`, and the law is asked for all of them.
!> Else those that touch are selected among them step by step. The gap is the one that makes choosing and what is done in vain
!> for pairs apart cheapest together.
!>
!> With friction a pair that touches has a slip, oriented from the row's parcel to the partner, and with the rolling spring an
!> angle rolled. Tight pairs have a record each. Of others there is a memory of those that touched in the last step, one behind
!> the other.
module close_pairs
  use contact_lanes, only: lanes, full_lanes, lane_of, group_of, record_rows
  use contact_list, only: contact_list_t, columns_at_once
  use kinds, only: wp
  use parcels, only: radius_row, mass_row
  implicit none
  private
  public :: close_pairs_t, pair_ways

  real(wp), parameter :: choosing_cost = 0.125_wp  !< of a parcel, over the forces of the pairs within a diameter around it
  real(wp), parameter :: looking_cost = 0.8_wp     !< the same over selecting among these pairs
  real(wp), parameter :: fewest_steps = 6.0_wp     !< for which asking the law of pairs apart pays
  integer, parameter :: block_pairs = 256
  real(wp), parameter :: difference(4) = [-1, -1, -1, 1]  !< x, y, z, r of a pair

  type :: close_pairs_t
    logical :: with_history = .false.
    logical :: with_angles = .false.      !< whether contacts remember how far they have rolled
    logical :: tight = .false.
    integer :: n = 0
    integer :: swept = 0                  !< pairs whose forces of this step are known
    integer :: window = 0                 !< columns that tight pairs of a stretch may need
    integer, allocatable :: entry(:)      !< (n) of the list
    integer, allocatable :: i(:), j(:)    !< (n) columns of the parcels
    real(wp), allocatable :: record(:,:,:)  !< (lanes, record_rows, for n) of tight pairs, see contact_lanes; those beyond n do
                                            !< no harm
    real(wp), allocatable :: angle(:,:)   !< (3, lanes for n) of tight pairs with the rolling spring: angle rolled [rad]
    integer, allocatable :: place(:)      !< (0:n) of other pairs: column of the memory, 0 if there is none
    integer :: memories = 0
    real(wp), allocatable :: memory(:,:)  !< (3 or 6, 0:memories at least) 1:3 slip [m], 4:6 angle [rad]; column 0 is 0
    real(wp), allocatable :: before(:,:)  !< that of the step before, for pairs that are not swept yet
    real(wp), private :: way_left = 0.0_wp  !< that parcels may go before the pairs are chosen again [m]
  contains
    procedure :: take_all
    procedure :: forget_all
    procedure :: make_room
    procedure :: note_way
    procedure :: is_due
    procedure :: begin_step
    procedure :: last_of_rows
    procedure :: remembers
    procedure :: memory_of
    procedure :: remind
  end type close_pairs_t

contains

  !> All pairs of a new list.
  subroutine take_all(self, list)
    class(close_pairs_t), intent(inout) :: self
    type(contact_list_t), intent(in) :: list

    integer :: k

    self%n = list%entries
    self%entry = [(k, k=1, self%n)]
    self%i = list%row(1:self%n)
    self%j = list%partner(1:self%n)
    self%way_left = 0.0_wp
    if (allocated(self%record)) deallocate (self%record)
    if (allocated(self%angle)) deallocate (self%angle)
    call self%forget_all()
  end subroutine take_all

  !> The pairs at hand are not tight and remember nothing.
  subroutine forget_all(self)
    class(close_pairs_t), intent(inout) :: self

    self%tight = .false.
    if (.not. self%with_history) return
    self%memories = 0
    if (allocated(self%place)) deallocate (self%place)
    allocate (self%place(0:self%n), source=0)
    if (allocated(self%memory)) return
    allocate (self%memory(merge(6, 3, self%with_angles), 0:0), source=0.0_wp)
    allocate (self%before, source=self%memory)
  end subroutine forget_all

  !> Room for so many memories; what there is stays.
  pure subroutine make_room(self, memories)
    class(close_pairs_t), intent(inout) :: self
    integer, intent(in) :: memories

    real(wp), allocatable :: larger(:,:)

    if (ubound(self%memory, 2) >= memories) return
    allocate (larger(size(self%memory, 1), 0:memories + memories/4))
    larger(:, 0:self%memories) = self%memory(:, 0:self%memories)
    call move_alloc(larger, self%memory)
  end subroutine make_room

  !> Whether a pair has a slip, or an angle.
  pure function remembers(self, pair)
    class(close_pairs_t), intent(in) :: self
    integer, intent(in) :: pair
    logical :: remembers

    if (self%tight) then
      remembers = any(abs(self%memory_of(pair)) > 0.0_wp)
    else
      remembers = self%place(pair) > 0
    end if
  end function remembers

  !> The slip of a pair and the angle, 0 if there is none.
  pure function memory_of(self, pair) result(memory)
    class(close_pairs_t), intent(in) :: self
    integer, intent(in) :: pair
    real(wp) :: memory(6)

    memory(4:6) = 0.0_wp
    if (self%tight) then
      memory(1:3) = self%record(lane_of(pair), 1:3, group_of(pair))
      if (self%with_angles) memory(4:6) = self%angle(:, pair)
    else
      memory(1:3) = self%memory(1:3, self%place(pair))
      if (self%with_angles) memory(4:6) = self%memory(4:6, self%place(pair))
    end if
  end function memory_of

  !> Give it to a pair, none of which is tight.
  pure subroutine remind(self, pair, memory)
    class(close_pairs_t), intent(inout) :: self
    integer, intent(in) :: pair
    real(wp), intent(in) :: memory(6)  !< as `memory_of`

    if (self%place(pair) == 0) then
      call self%make_room(self%memories + 1)
      self%memories = self%memories + 1
      self%place(pair) = self%memories
    end if
    self%memory(:, self%place(pair)) = memory(:size(self%memory, 1))
  end subroutine remind

  !> Parcels have gone so far at most.
  elemental subroutine note_way(self, way)
    class(close_pairs_t), intent(inout) :: self
    real(wp), intent(in) :: way  !< [m]

    self%way_left = self%way_left - way
  end subroutine note_way

  !> Whether the next step chooses anew.
  pure function is_due(self)
    class(close_pairs_t), intent(in) :: self
    logical :: is_due

    is_due = self%way_left <= 0.0_wp
  end function is_due

  !> Nothing is swept yet. Choose anew if parcels have gone too far.
  subroutine begin_step(self, list, state, way, skin, width)
    class(close_pairs_t), intent(inout) :: self
    type(contact_list_t), intent(in) :: list
    real(wp), intent(in), contiguous :: state(:,:)  !< see parcels
    real(wp), intent(in) :: way             !< of the fastest parcel in a step [m]
    real(wp), intent(in) :: skin            !< of the list [m]
    real(wp), intent(in) :: width           !< of a parcel [m]

    real(wp), allocatable :: memory(:,:)
    real(wp) :: steps, gap
    logical :: tight

    self%swept = 0
    if (self%is_due()) then
      steps = sqrt(choosing_cost*width/max(2*way, tiny(way)))
      tight = steps > fewest_steps
      if (.not. tight) steps = steps*sqrt(looking_cost/choosing_cost)
      gap = min(2*way*steps, skin)
      if (self%tight) call loosen(self)
      call choose(self, list, state, gap)
      self%window = 0
      if (tight) then
        call tighten(self, state)
        self%window = columns_at_once(self%i, self%j, list%rows, lanes)
      end if
      self%way_left = gap/2
    end if
    if (self%tight .or. .not. self%with_history) return
    ! what this step leaves is written over what the step before the last one left
    call move_alloc(self%memory, memory)
    call move_alloc(self%before, self%memory)
    call move_alloc(memory, self%before)
    self%memories = 0
  end subroutine begin_step

  !> The last pair in rows up to the given one; of tight pairs some more for full lanes.
  pure function last_of_rows(self, row) result(last)
    class(close_pairs_t), intent(in) :: self
    integer, intent(in) :: row
    integer :: last

    integer :: beyond, middle

    last = self%swept
    beyond = self%n + 1
    do while (beyond - last > 1)
      middle = (last + beyond)/2
      if (self%i(middle) <= row) then
        last = middle
      else
        beyond = middle
      end if
    end do
    if (self%tight) last = min(full_lanes(last), self%n)
  end function last_of_rows

  !> The listed pairs with a gap less than `gap` become the close ones; they are not tight.
  subroutine choose(self, list, state, gap)
    class(close_pairs_t), intent(inout) :: self
    type(contact_list_t), intent(in) :: list
    real(wp), intent(in), contiguous :: state(:,:)
    real(wp), intent(in) :: gap      !< [m]

    integer :: entry(list%entries), first, count, m, n, near(block_pairs)
    real(wp) :: way(4, block_pairs)

    n = 0
    do first = 0, list%entries - 1, block_pairs
      count = min(list%entries - first, block_pairs)
      call pair_ways(size(state, 1), state, count, list%row(first + 1:), list%partner(first + 1:), way)
      !$omp simd
      do m = 1, count
        near(m) = merge(1, 0, way(1, m)**2 + way(2, m)**2 + way(3, m)**2 - (way(4, m) + gap)**2 < 0.0_wp)
      end do
      do m = 1, count
        entry(n + 1) = first + m
        n = n + near(m)
      end do
    end do
    if (self%with_history) call keep_memories(self, list%entries, entry(1:n))
    self%n = n
    self%entry = entry(1:n)
    self%i = list%row(entry(1:n))
    self%j = list%partner(entry(1:n))
  end subroutine choose

  !> Pairs that were others before keep their memories.
  subroutine keep_memories(self, entries, entry)
    class(close_pairs_t), intent(inout) :: self
    integer, intent(in) :: entries   !< of the list
    integer, intent(in) :: entry(:)  !< of the new pairs

    integer :: of_list(entries)
    integer, allocatable :: place(:)

    of_list = 0
    of_list(self%entry(1:self%n)) = self%place(1:self%n)
    allocate (place(0:size(entry)))
    place(0) = 0
    place(1:) = of_list(entry)
    call move_alloc(place, self%place)
  end subroutine keep_memories

  !> Records for all pairs, with what they remember.
  subroutine tighten(self, state)
    class(close_pairs_t), intent(inout) :: self
    real(wp), intent(in) :: state(:,:)  !< see parcels

    integer :: lanes_in_use, pair

    self%tight = .true.
    if (.not. self%with_history) return
    lanes_in_use = full_lanes(self%n)
    allocate (self%record(lanes, record_rows, lanes_in_use/lanes), source=0.0_wp)
    if (self%with_angles) allocate (self%angle(3, lanes_in_use), source=0.0_wp)
    do pair = 1, self%n
      associate (l => lane_of(pair), g => group_of(pair), i => self%i(pair), j => self%j(pair), &
                 memory => self%memory(:, self%place(pair)))
        self%record(l, 1:3, g) = memory(1:3)
        self%record(l, 4, g) = 1/sqrt(state(mass_row, i) + state(mass_row, j))
        self%record(l, 5, g) = 1/(state(radius_row, i) + state(radius_row, j))
        if (self%with_angles) self%angle(:, pair) = memory(4:6)
      end associate
    end do
    deallocate (self%place, self%memory, self%before)
    self%memories = 0
  end subroutine tighten

  !> Memories of those pairs that have a slip or an angle.
  subroutine loosen(self)
    class(close_pairs_t), intent(inout) :: self

    real(wp) :: memory(6)
    integer :: pair

    call self%forget_all()
    if (.not. self%with_history) return
    memory = 0.0_wp
    do pair = 1, self%n
      memory(1:3) = self%record(lane_of(pair), 1:3, group_of(pair))
      if (self%with_angles) memory(4:6) = self%angle(:, pair)
      if (any(abs(memory) > 0.0_wp)) call self%remind(pair, memory)
    end do
    deallocate (self%record)
    if (self%with_angles) deallocate (self%angle)
  end subroutine loosen

  !> x_i - x_j and r_i + r_j of pairs [m].
  pure subroutine pair_ways(rows, state, n, i, j, way)
    integer, intent(in) :: rows, n
    real(wp), intent(in) :: state(rows, *)
    integer, intent(in) :: i(n), j(n)
    real(wp), intent(inout) :: way(4, n)

    integer :: l, m

    do m = 1, n
      !$omp simd simdlen(4)
      do l = 1, 4
        way(l, m) = state(l, i(m)) + difference(l)*state(l, j(m))
      end do
    end do
  end subroutine pair_ways

end module close_pairs
