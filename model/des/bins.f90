!> A lattice of boxes that parcels are sorted into, so that near parcels are near in memory.
!>
!> The lattice spans the parcels it is made for. Bins are counted along its shortest axis first and along its longest
!> last: so the neighbours of a parcel lie in a few runs of columns, and those of the next layer not far behind, still in
!> the cache when their turn comes.
module bins
  use kinds, only: wp
  implicit none
  private
  public :: bins_t

  type :: bins_t
    integer :: axis(3)            !< x, y, z as 1, 2, 3 from the shortest to the longest; what follows is in this order
    real(wp) :: lower(3)          !< lowest corner [m]
    real(wp) :: per_edge(3)       !< inverse of the edges of a bin [1/m]
    integer :: n(3)               !< bins along each axis
    integer, allocatable :: first(:)  !< (product(n)+1) place of the first parcel of each bin in the sorted order
  contains
    procedure :: span
    procedure :: bin_of
    procedure :: number_of
    procedure :: sort
  end type bins_t

contains

  !> Lay the lattice over a box, with edges of at least `edge` and not many more bins than `most`.
  pure subroutine span(self, lower, upper, edge, most)
    class(bins_t), intent(inout) :: self
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    real(wp), intent(in) :: edge                !< [m]
    integer, intent(in) :: most

    integer, parameter :: fewest = 64
    real(wp) :: size_of_bin, extent(3)

    self%axis = order_of(upper - lower)
    self%lower = lower(self%axis)
    extent = upper(self%axis) - self%lower
    size_of_bin = edge
    do
      self%n = max(1, int(min(extent/size_of_bin, 1.0e6_wp)))
      if (product(real(self%n, wp)) <= real(max(fewest, most), wp)) exit
      size_of_bin = 1.26_wp*size_of_bin
    end do
    self%per_edge = self%n/max(extent, size_of_bin)
    if (allocated(self%first)) then
      if (size(self%first) /= product(self%n) + 1) deallocate (self%first)
    end if
    if (.not. allocated(self%first)) allocate (self%first(product(self%n) + 1))
  end subroutine span

  !> The axes from the shortest to the longest; equals keep their order.
  pure function order_of(extent) result(axis)
    real(wp), intent(in) :: extent(3)  !< [m]
    integer :: axis(3)

    integer :: a

    do a = 1, 3
      axis(1 + count(extent < extent(a)) + count(extent(:a - 1) <= extent(a) .and. extent(:a - 1) >= extent(a))) = a
    end do
  end function order_of

  !> The bin of a point, counted from 0 along each axis.
  pure function bin_of(self, x) result(bin)
    class(bins_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    integer :: bin(3)

    bin = min(max(int((x(self%axis) - self%lower)*self%per_edge), 0), self%n - 1)
  end function bin_of

  !> The number of a bin from 1, the shortest axis fastest.
  pure function number_of(self, a, b, c) result(number)
    class(bins_t), intent(in) :: self
    integer, intent(in) :: a, b, c  !< place of the bin along the axes, from 0
    integer :: number

    number = 1 + a + self%n(1)*(b + self%n(2)*c)
  end function number_of

  !> Sort columns of `state` by bin; equals keep their order. `first` counts their places from before + 1.
  pure subroutine sort(self, state, before, columns)
    class(bins_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: state(:,:)  !< 1:3 position [m]
    integer, intent(in) :: before                   !< places before the first
    integer, intent(inout) :: columns(:)

    integer :: i, b, next, count, place(size(columns)), old(size(columns)), bin(3)

    old = columns
    self%first = 0
    do i = 1, size(old)
      bin = self%bin_of(state(1:3, old(i)))
      b = self%number_of(bin(1), bin(2), bin(3))
      place(i) = b
      self%first(b) = self%first(b) + 1
    end do
    next = before + 1
    do b = 1, size(self%first)
      count = self%first(b)
      self%first(b) = next
      next = next + count
    end do
    do i = 1, size(old)
      b = place(i)
      columns(self%first(b) - before) = old(i)
      self%first(b) = self%first(b) + 1
    end do
    do b = size(self%first), 2, -1
      self%first(b) = self%first(b - 1)
    end do
    self%first(1) = before + 1
  end subroutine sort

end module bins
