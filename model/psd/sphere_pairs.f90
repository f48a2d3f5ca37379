!> Spheres in a vessel, and which of them are near each other.
!>
!> Every pair is found once, by its larger sphere, which looks as far as its own size demands. So the cost grows
!> with the number of spheres and with the volume they take, not with the ratio of their sizes.
module sphere_pairs
  use kinds, only: wp
  use vessel, only: vessel_t
  implicit none
  private
  public :: spheres_t, pairs_t, find_pairs

  type :: spheres_t
    type(vessel_t) :: vessel
    real(wp), allocatable :: position(:, :)  !< (3,n) centres, in periodic directions inside the vessel [m]
    real(wp), allocatable :: radius(:)       !< (n) [m]
    integer, allocatable :: box(:)           !< (n) the box each has to stay in; 0: held where it is
  end type spheres_t

  !> The neighbours of sphere i are with(first(i):first(i+1)-1).
  type :: pairs_t
    integer, allocatable :: first(:)  !< (spheres+1)
    integer, allocatable :: with(:)   !< the other sphere of each pair
  end type pairs_t

  !> Spheres sorted by the cell their centre lies in; cells are counted from 0 in each direction, x fastest.
  type :: cells_t
    integer :: n(3)                          !< cells in each direction
    real(wp) :: lower(3)                     !< lowest corner [m]
    real(wp) :: edge(3)                      !< edges of a cell [m]
    integer, allocatable :: first(:)         !< (0:cells) place of the first sphere of each cell
    integer, allocatable :: sphere(:)        !< spheres by cell
    real(wp), allocatable :: position(:, :)  !< their centres [m]
    real(wp), allocatable :: radius(:)       !< their radii [m]
  end type cells_t

contains

  !> All pairs whose surfaces are closer than `room`.
  subroutine find_pairs(spheres, room, pairs)
    type(spheres_t), intent(in) :: spheres
    real(wp), intent(in) :: room  !< [m]
    type(pairs_t), intent(inout) :: pairs

    type(cells_t) :: cells
    integer :: i, n, found

    n = size(spheres%radius)
    if (.not. allocated(pairs%with)) allocate (pairs%with(10*n + 1000))
    if (allocated(pairs%first)) deallocate (pairs%first)
    allocate (pairs%first(n + 1), source=1)
    if (n == 0) return
    call sort_into_cells(spheres, room, cells)
    found = 0
    do i = 1, n
      pairs%first(i) = found + 1
      call find_smaller(spheres, room, cells, i, pairs, found)
    end do
    pairs%first(n + 1) = found + 1
  end subroutine find_pairs

  !> Cells about as wide as a mean sphere and its room, over the spheres and all of a periodic direction.
  subroutine sort_into_cells(spheres, room, cells)
    type(spheres_t), intent(in) :: spheres
    real(wp), intent(in) :: room  !< [m]
    type(cells_t), intent(out) :: cells

    real(wp) :: extent(3), wanted
    integer :: n

    n = size(spheres%radius)
    cells%lower = minval(spheres%position, 2)
    extent = maxval(spheres%position, 2) - cells%lower
    where (spheres%vessel%periodic)
      cells%lower = spheres%vessel%lower
      extent = spheres%vessel%upper - spheres%vessel%lower
    end where
    wanted = 2.0_wp*sum(spheres%radius)/n + room
    wanted = max(wanted, (product(max(extent, wanted))/(4*n))**(1.0_wp/3.0_wp))
    cells%n = max(int(extent/wanted), 1)
    cells%edge = max(extent/cells%n, merge(wanted, 0.0_wp, cells%n == 1))
    call sort_spheres(spheres, cells)
  end subroutine sort_into_cells

  !> Put the spheres in the order of their cells; those of one cell keep theirs.
  subroutine sort_spheres(spheres, cells)
    type(spheres_t), intent(in) :: spheres
    type(cells_t), intent(inout) :: cells

    integer, allocatable :: home(:), next(:)
    integer :: i, n, cell, place

    n = size(spheres%radius)
    allocate (home(n), cells%sphere(n), cells%position(3, n), cells%radius(n))
    allocate (cells%first(0:product(cells%n)), next(0:product(cells%n)), source=0)
    do i = 1, n
      home(i) = number_of(cells, place_of(cells, spheres%position(:, i)))
      cells%first(home(i) + 1) = cells%first(home(i) + 1) + 1
    end do
    cells%first(0) = 1
    do cell = 1, product(cells%n)
      cells%first(cell) = cells%first(cell - 1) + cells%first(cell)
    end do
    next(:) = cells%first
    do i = 1, n
      place = next(home(i))
      next(home(i)) = place + 1
      cells%sphere(place) = i
      cells%position(:, place) = spheres%position(:, i)
      cells%radius(place) = spheres%radius(i)
    end do
  end subroutine sort_spheres

  !> The cell a point lies in, the nearest one for a point beyond them.
  pure function place_of(cells, x) result(place)
    type(cells_t), intent(in) :: cells
    real(wp), intent(in) :: x(3)  !< [m]
    integer :: place(3)

    place = min(max(int((x - cells%lower)/cells%edge), 0), cells%n - 1)
  end function place_of

  pure function number_of(cells, place) result(number)
    type(cells_t), intent(in) :: cells
    integer, intent(in) :: place(3)
    integer :: number

    number = place(1) + cells%n(1)*(place(2) + cells%n(2)*place(3))
  end function number_of

  !> Add to the list the smaller spheres near sphere i; of equal ones, those that come before it.
  !> Cells in a row along x hold neighbouring places, so a row is searched at once.
  subroutine find_smaller(spheres, room, cells, i, pairs, found)
    type(spheres_t), intent(in) :: spheres
    real(wp), intent(in) :: room  !< [m]
    type(cells_t), intent(in) :: cells
    integer, intent(in) :: i
    type(pairs_t), intent(inout) :: pairs
    integer, intent(inout) :: found  !< pairs in the list

    real(wp) :: x(3), radius, length(3), half(3)
    integer :: low(3), high(3), place(3), reach(3), j, k, row

    x = spheres%position(:, i)
    radius = spheres%radius(i)
    call spheres%vessel%periods(length, half)
    place = place_of(cells, spheres%position(:, i))
    reach = ceiling((2.0_wp*spheres%radius(i) + room)/cells%edge)
    low = max(place - reach, 0)
    high = min(place + reach, cells%n - 1)
    where (spheres%vessel%periodic .and. 2*reach + 1 <= cells%n)
      low = place - reach
      high = place + reach
    elsewhere (spheres%vessel%periodic)
      low = 0
      high = cells%n - 1
    end where
    do k = low(3), high(3)
      do j = low(2), high(2)
        row = number_of(cells, [0, modulo(j, cells%n(2)), modulo(k, cells%n(3))])
        call search(row + max(low(1), 0), row + min(high(1), cells%n(1) - 1))
        if (low(1) < 0) call search(row + low(1) + cells%n(1), row + cells%n(1) - 1)
        if (high(1) >= cells%n(1)) call search(row, row + high(1) - cells%n(1))
      end do
    end do

  contains

    !> Compare sphere i with those of some cells in a row.
    subroutine search(first, last)
      integer, intent(in) :: first, last  !< cells

      real(wp) :: way(3)
      integer :: other

      if (found + cells%first(last + 1) - cells%first(first) > size(pairs%with)) call lengthen(pairs%with, found)
      do other = cells%first(first), cells%first(last + 1) - 1
        if (cells%radius(other) > radius) cycle
        way = cells%position(:, other) - x
        way = way - merge(length, 0.0_wp, way > half) + merge(length, 0.0_wp, way < -half)
        if (way(1)**2 + way(2)**2 + way(3)**2 >= (radius + cells%radius(other) + room)**2) cycle
        if (cells%radius(other) >= radius .and. cells%sphere(other) >= i) cycle
        found = found + 1
        pairs%with(found) = cells%sphere(other)
      end do
    end subroutine search

  end subroutine find_smaller

  !> Make room in a list for twice as many, keeping the first ones.
  pure subroutine lengthen(list, kept)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: kept

    integer, allocatable :: longer(:)

    allocate (longer(2*size(list)))
    longer(:kept) = list(:kept)
    call move_alloc(longer, list)
  end subroutine lengthen

end module sphere_pairs
