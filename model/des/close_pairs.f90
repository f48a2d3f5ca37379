!> Of the listed pairs those that may touch soon, and their slips.
!>
!> In a bed at rest half of the listed pairs do not touch, and parcels take hundreds of steps to change that. So the pairs
!> nearer than a small gap are chosen for some steps, in the order of the list, and the law is asked for all of them: they are
!> `tight`. The gap is the one that makes choosing and the forces of pairs apart cheapest together. Where parcels are so fast
!> that choosing would not pay, all listed pairs are close, and those that touch are selected step by step.
!>
!> With friction every close pair has its slip, oriented from the row's parcel to the partner, and the number of the last step
!> in which it touched: a slip older than one step is that of an earlier contact and counts as none.
module close_pairs
  use contact_lanes, only: lanes
  use contact_list, only: contact_list_t
  use kinds, only: wp
  implicit none
  private
  public :: close_pairs_t, pair_ways, never

  real(wp), parameter :: never = -1.0_wp        !< the last touch of a pair that has not touched yet
  real(wp), parameter :: choosing_cost = 0.125_wp  !< of a parcel, over the forces of the pairs within a diameter around it
  real(wp), parameter :: fewest_steps = 3.0_wp  !< for which choosing pays
  real(wp), parameter :: patience = 16.0_wp     !< steps until it is asked again whether it would
  integer, parameter :: block_pairs = 256
  real(wp), parameter :: difference(4) = [-1, -1, -1, 1]  !< x, y, z, r of a pair

  type :: close_pairs_t
    logical :: with_history = .false.
    logical :: with_angles = .false.      !< whether contacts remember how far they have rolled
    logical :: tight = .false.
    integer :: n = 0
    integer :: swept = 0                  !< pairs whose forces of this step are known
    integer, allocatable :: entry(:)      !< (n at least) of the list
    integer, allocatable :: i(:), j(:)    !< (n at least) columns of the parcels
    real(wp), allocatable :: slip(:,:)    !< (4, n + lanes at least) 1:3 tangential slip [m], 4 step of last touch
    real(wp), allocatable :: angle(:,:)   !< (3, n at least) with the rolling spring: angle rolled [rad]
    real(wp), private :: way_left = 0.0_wp  !< that parcels may go before the pairs are chosen again [m]
  contains
    procedure :: take_all
    procedure :: note_way
    procedure :: begin_step
    procedure :: last_of_rows
    procedure :: memory_of
    procedure :: remind
  end type close_pairs_t

contains

  !> All pairs of a new list; nothing has touched yet.
  subroutine take_all(self, list)
    class(close_pairs_t), intent(inout) :: self
    type(contact_list_t), intent(in) :: list

    integer :: k

    call reserve(self, list%entries)
    self%tight = .false.
    self%n = list%entries
    self%way_left = 0.0_wp
    do k = 1, list%entries
      self%entry(k) = k
    end do
    self%i(1:self%n) = list%row(1:self%n)
    self%j(1:self%n) = list%partner(1:self%n)
    if (.not. self%with_history) return
    self%slip(1:3, 1:self%n + lanes) = 0.0_wp
    self%slip(4, 1:self%n + lanes) = never
    if (self%with_angles) self%angle(:, 1:self%n) = 0.0_wp
  end subroutine take_all

  subroutine reserve(self, pairs)
    class(close_pairs_t), intent(inout) :: self
    integer, intent(in) :: pairs

    if (allocated(self%entry)) then
      if (size(self%entry) >= pairs) return
      deallocate (self%entry, self%i, self%j)
      if (self%with_history) deallocate (self%slip)
      if (self%with_angles) deallocate (self%angle)
    end if
    allocate (self%entry(pairs + pairs/8), self%i(pairs + pairs/8), self%j(pairs + pairs/8))
    if (self%with_history) allocate (self%slip(4, pairs + pairs/8 + lanes))
    if (self%with_angles) allocate (self%angle(3, pairs + pairs/8))
  end subroutine reserve

  !> What a pair remembers beside the step of its last touch: the slip and, if there is one, the angle.
  pure function memory_of(self, pair) result(memory)
    class(close_pairs_t), intent(in) :: self
    integer, intent(in) :: pair
    real(wp) :: memory(merge(6, 3, self%with_angles))

    memory(1:3) = self%slip(1:3, pair)
    if (self%with_angles) memory(4:6) = self%angle(:, pair)
  end function memory_of

  !> Give it back.
  pure subroutine remind(self, pair, memory, step)
    class(close_pairs_t), intent(inout) :: self
    integer, intent(in) :: pair
    real(wp), intent(in) :: memory(:)  !< as `memory_of`
    real(wp), intent(in) :: step       !< of the last touch

    self%slip(:, pair) = [memory(1:3), step]
    if (self%with_angles) self%angle(:, pair) = memory(4:6)
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
    if (tight .or. self%tight) call choose(self, list, state, gap)
    self%tight = tight
    self%way_left = merge(gap/2, patience*way, tight)
  end subroutine begin_step

  !> The last pair in rows up to the given one.
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
  end function last_of_rows

  !> The listed pairs with a gap less than `gap` become the close ones and keep their slips.
  subroutine choose(self, list, state, gap)
    class(close_pairs_t), intent(inout) :: self
    type(contact_list_t), intent(in) :: list
    real(wp), intent(in), contiguous :: state(:,:)
    real(wp), intent(in) :: gap  !< [m]

    integer, allocatable :: old_entry(:)
    real(wp), allocatable :: old_slip(:,:), old_angle(:,:)
    real(wp) :: way(4, block_pairs)
    integer :: before, count, m, n, old_n

    allocate (old_slip(4, 0), old_angle(3, 0))
    call move_alloc(self%entry, old_entry)
    if (self%with_history) call move_alloc(self%slip, old_slip)
    if (self%with_angles) call move_alloc(self%angle, old_angle)
    old_n = self%n
    deallocate (self%i, self%j)
    call reserve(self, list%entries)
    n = 0
    do before = 0, list%entries - 1, block_pairs
      count = min(list%entries - before, block_pairs)
      call pair_ways(size(state, 1), state, count, list%row(before + 1:), list%partner(before + 1:), way)
      do m = 1, count
        self%entry(n + 1) = before + m
        n = n + merge(1, 0, way(1, m)**2 + way(2, m)**2 + way(3, m)**2 < (way(4, m) + gap)**2)
      end do
    end do
    self%n = n
    do m = 1, n
      self%i(m) = list%row(self%entry(m))
      self%j(m) = list%partner(self%entry(m))
    end do
    if (self%with_history) call give_slips(old_entry(1:old_n), old_slip, old_angle, self)
  end subroutine choose

  !> Pairs that were close before keep their slips, and angles.
  pure subroutine give_slips(old_entry, old_slip, old_angle, self)
    integer, intent(in) :: old_entry(:)
    real(wp), intent(in) :: old_slip(:,:), old_angle(:,:)
    class(close_pairs_t), intent(inout) :: self

    integer :: m, p

    p = 1
    do m = 1, self%n
      do while (p <= size(old_entry))
        if (old_entry(p) >= self%entry(m)) exit
        p = p + 1
      end do
      self%slip(:, m) = [0.0_wp, 0.0_wp, 0.0_wp, never]
      if (self%with_angles) self%angle(:, m) = 0.0_wp
      if (p > size(old_entry)) cycle
      if (old_entry(p) /= self%entry(m)) cycle
      self%slip(:, m) = old_slip(:, p)
      if (self%with_angles) self%angle(:, m) = old_angle(:, p)
    end do
    self%slip(1:3, self%n + 1:self%n + lanes) = 0.0_wp
    self%slip(4, self%n + 1:self%n + lanes) = never
  end subroutine give_slips

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
