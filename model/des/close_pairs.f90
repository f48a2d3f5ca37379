!> Of the listed pairs those that may touch soon, and their slips.
!>
!> In a bed at rest half of the listed pairs do not touch, and parcels take hundreds of steps to change that. So the pairs
!> nearer than a small gap are chosen for some steps, in the order of the list, and the law is asked for all of them: they are
!> `tight`. The gap is the one that makes choosing and the forces of pairs apart cheapest together. Where parcels are so fast
!> that choosing would not pay, all listed pairs are close, and those that touch are selected step by step.
!>
!> With friction every close pair has a record, of which the slip is oriented from the row's parcel to the partner. A pair that
!> does not touch has no slip. So of pairs apart, the law is also asked for those that touched in the step before.
module close_pairs
  use contact_lanes, only: lanes, full_lanes, lane_of, group_of, record_rows
  use contact_list, only: contact_list_t
  use kinds, only: wp
  use parcels, only: radius_row, mass_row
  implicit none
  private
  public :: close_pairs_t, pair_ways

  real(wp), parameter :: choosing_cost = 0.125_wp  !< of a parcel, over the forces of the pairs within a diameter around it
  real(wp), parameter :: fewest_steps = 3.0_wp  !< for which choosing pays
  real(wp), parameter :: patience = 16.0_wp     !< steps until it is asked again whether it would
  integer, parameter :: block_pairs = 256
  real(wp), parameter :: difference(4) = [-1, -1, -1, 1]  !< x, y, z, r of a pair

  integer, parameter :: byte = selected_int_kind(2)

  type :: close_pairs_t
    logical :: with_history = .false.
    logical :: with_angles = .false.      !< whether contacts remember how far they have rolled
    logical :: tight = .false.
    integer :: n = 0
    integer :: swept = 0                  !< pairs whose forces of this step are known
    integer, allocatable :: entry(:)      !< (n at least) of the list
    integer, allocatable :: i(:), j(:)    !< (n at least) columns of the parcels
    real(wp), allocatable :: record(:,:,:)  !< (lanes, record_rows, for n at least) see contact_lanes; those beyond n do no harm
    real(wp), allocatable :: angle(:,:)   !< (3, as many) with the rolling spring: angle rolled [rad]
    logical(byte), allocatable :: held(:)  !< (n at least) of pairs apart: whether the pair may have a slip
    real(wp), private :: way_left = 0.0_wp  !< that parcels may go before the pairs are chosen again [m]
  contains
    procedure :: take_all
    procedure :: reserve_memory
    procedure :: note_way
    procedure :: begin_step
    procedure :: last_of_rows
    procedure :: remembers
    procedure :: memory_of
    procedure :: remind
  end type close_pairs_t

contains

  !> All pairs of a new list; nothing has touched yet.
  subroutine take_all(self, list, state)
    class(close_pairs_t), intent(inout) :: self
    type(contact_list_t), intent(in) :: list
    real(wp), intent(in), contiguous :: state(:,:)  !< see parcels

    integer :: k

    self%tight = .false.
    self%n = list%entries
    self%way_left = 0.0_wp
    self%entry = [(k, k=1, self%n)]
    self%i = list%row(1:self%n)
    self%j = list%partner(1:self%n)
    if (.not. self%with_history) return
    call self%reserve_memory()
    do k = 1, self%n
      call begin_record(self, k, state)
    end do
  end subroutine take_all

  !> Room for what is kept of the pairs, which are known. What was kept is lost.
  subroutine reserve_memory(self)
    class(close_pairs_t), intent(inout) :: self

    integer :: groups

    groups = full_lanes(self%n)/lanes
    if (allocated(self%record)) then
      if (size(self%record, 3) < groups) deallocate (self%record)
    end if
    if (.not. allocated(self%record)) allocate (self%record(lanes, record_rows, groups + groups/8))
    if (groups > 0) self%record(:, :, groups) = 0.0_wp
    if (self%tight .and. allocated(self%held)) deallocate (self%held)
    if (.not. self%tight) self%held = spread(.false._byte, 1, self%n)
    if (.not. self%with_angles) return
    if (allocated(self%angle)) then
      if (size(self%angle, 2) < lanes*groups) deallocate (self%angle)
    end if
    if (.not. allocated(self%angle)) allocate (self%angle(3, lanes*(groups + groups/8)))
    if (groups > 0) self%angle(:, lanes*(groups - 1) + 1:lanes*groups) = 0.0_wp
  end subroutine reserve_memory

  !> What is kept of a pair that does not touch.
  pure subroutine begin_record(self, pair, state)
    class(close_pairs_t), intent(inout) :: self
    integer, intent(in) :: pair
    real(wp), intent(in) :: state(:,:)  !< see parcels

    associate (l => lane_of(pair), g => group_of(pair), i => self%i(pair), j => self%j(pair))
      self%record(l, 1:3, g) = 0.0_wp
      self%record(l, 4, g) = 1/sqrt(state(mass_row, i) + state(mass_row, j))
      self%record(l, 5, g) = 1/(state(radius_row, i) + state(radius_row, j))
    end associate
    if (self%with_angles) self%angle(:, pair) = 0.0_wp
  end subroutine begin_record

  !> Whether a pair has a slip, or an angle.
  pure function remembers(self, pair)
    class(close_pairs_t), intent(in) :: self
    integer, intent(in) :: pair
    logical :: remembers

    associate (slip => self%record(lane_of(pair), 1:3, group_of(pair)))
      remembers = any(abs(slip) > 0.0_wp)
    end associate
    if (self%with_angles) remembers = remembers .or. any(abs(self%angle(:, pair)) > 0.0_wp)
  end function remembers

  !> The slip of a pair and, if there is one, the angle.
  pure function memory_of(self, pair) result(memory)
    class(close_pairs_t), intent(in) :: self
    integer, intent(in) :: pair
    real(wp) :: memory(merge(6, 3, self%with_angles))

    memory(1:3) = self%record(lane_of(pair), 1:3, group_of(pair))
    if (self%with_angles) memory(4:6) = self%angle(:, pair)
  end function memory_of

  !> Give it back.
  pure subroutine remind(self, pair, memory)
    class(close_pairs_t), intent(inout) :: self
    integer, intent(in) :: pair
    real(wp), intent(in) :: memory(:)  !< as `memory_of`

    self%record(lane_of(pair), 1:3, group_of(pair)) = memory(1:3)
    if (self%with_angles) self%angle(:, pair) = memory(4:6)
    if (.not. self%tight) self%held(pair) = .true.
  end subroutine remind

  !> Parcels have gone so far at most.
  elemental subroutine note_way(self, way)
    class(close_pairs_t), intent(inout) :: self
    real(wp), intent(in) :: way  !< [m]

    self%way_left = self%way_left - way
  end subroutine note_way

  !> Nothing is swept yet. Choose anew if parcels have gone too far.
  subroutine begin_step(self, list, state, way, skin, width)
    class(close_pairs_t), intent(inout) :: self
    type(contact_list_t), intent(in) :: list
    real(wp), intent(in), contiguous :: state(:,:)  !< see parcels
    real(wp), intent(in) :: way             !< of the fastest parcel in a step [m]
    real(wp), intent(in) :: skin            !< of the list [m]
    real(wp), intent(in) :: width           !< of a parcel [m]

    real(wp) :: steps, gap
    logical :: tight

    self%swept = 0
    if (self%way_left > 0.0_wp) return
    steps = sqrt(choosing_cost*width/max(2*way, tiny(way)))
    tight = steps > fewest_steps
    gap = skin
    if (tight) gap = min(2*way*steps, skin)
    if (tight .or. self%tight) call choose(self, list, state, gap, tight)
    self%way_left = merge(gap/2, patience*way, tight)
  end subroutine begin_step

  !> The last pair in rows up to the given one, or some more for full lanes.
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
    last = min(full_lanes(last), self%n)
  end function last_of_rows

  !> The listed pairs with a gap less than `gap` become the close ones and keep what they remember.
  subroutine choose(self, list, state, gap, tight)
    class(close_pairs_t), intent(inout) :: self
    type(contact_list_t), intent(in) :: list
    real(wp), intent(in), contiguous :: state(:,:)
    real(wp), intent(in) :: gap      !< [m]
    logical, intent(in) :: tight

    integer :: entry(list%entries), before, count, m, n
    real(wp) :: way(4, block_pairs)
    type(close_pairs_t) :: old

    n = 0
    do before = 0, list%entries - 1, block_pairs
      count = min(list%entries - before, block_pairs)
      call pair_ways(size(state, 1), state, count, list%row(before + 1:), list%partner(before + 1:), way)
      do m = 1, count
        entry(n + 1) = before + m
        n = n + merge(1, 0, way(1, m)**2 + way(2, m)**2 + way(3, m)**2 < (way(4, m) + gap)**2)
      end do
    end do
    old%n = self%n
    call move_alloc(self%entry, old%entry)
    self%n = n
    self%tight = tight
    self%entry = entry(1:n)
    self%i = list%row(self%entry)
    self%j = list%partner(self%entry)
    if (.not. self%with_history) return
    allocate (old%angle(3, 0))
    call move_alloc(self%record, old%record)
    if (self%with_angles) call move_alloc(self%angle, old%angle)
    call self%reserve_memory()
    call remember(self, old, state)
  end subroutine choose

  !> Pairs that were close before keep what is kept of them.
  pure subroutine remember(self, old, state)
    class(close_pairs_t), intent(inout) :: self
    type(close_pairs_t), intent(in) :: old
    real(wp), intent(in) :: state(:,:)

    integer :: m, p

    p = 1
    do m = 1, self%n
      do while (p <= old%n)
        if (old%entry(p) >= self%entry(m)) exit
        p = p + 1
      end do
      if (p <= old%n) then
        if (old%entry(p) == self%entry(m)) then
          self%record(lane_of(m), :, group_of(m)) = old%record(lane_of(p), :, group_of(p))
          if (self%with_angles) self%angle(:, m) = old%angle(:, p)
          if (.not. self%tight) self%held(m) = .true.
          cycle
        end if
      end if
      call begin_record(self, m, state)
    end do
  end subroutine remember

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
