!> Which pairs of parcels may touch before the list is made again.
!>
!> Parcels are dealt to levels by size, the smallest first, and each level is sorted into a lattice of its own, with
!> bins as wide as the range of its largest pair. So a bin holds few parcels however wide the distribution is. A pair
!> is found by its smaller parcel: in its own level among those behind it, in the levels of larger ones all around.
!> Columns are counted level after level, so the smaller parcel has the lower column and the pair is in its row.
module neighbours
  use bins, only: bins_t
  use contact_list, only: contact_list_t
  use kinds, only: wp
  use parcels, only: parcels_t, radius_row
  implicit none
  private
  public :: search_t

  real(wp), parameter :: factor = 2.0_wp       !< between the sizes of a level, about
  integer, parameter :: most_levels = 12
  integer, parameter :: bins_per_parcel = 4    !< of a lattice, at most, over all my parcels
  real(wp), parameter :: wider = 1 + 1e-9_wp   !< a range that rounding cannot make too short

  !> Parcels of similar size; mine are in the columns first to last.
  type :: level_t
    real(wp) :: largest = 0.0_wp            !< radius [m]
    integer :: first = 1, last = 0
    integer :: n_ghosts = 0
    type(bins_t) :: own, ghosts
  end type level_t

  type :: search_t
    type(level_t), allocatable :: level(:)  !< the smallest first
    real(wp) :: box(3, 2) = 0.0_wp          !< around the centres of all my parcels [m]
    real(wp), allocatable :: place(:,:)     !< (4,n) 1:3 position, 4 radius of my parcels [m]
    real(wp), allocatable :: ghost(:,:)     !< (4,n_ghost) the same of ghosts, sorted [m]
    integer, allocatable :: column(:)       !< (n_ghost) of the ghosts so sorted
  contains
    procedure :: set_levels
    procedure :: sort_own
    procedure :: build
  end type search_t

contains

  !> As many levels as make the sizes in each differ by about `factor`; one for a distribution that is narrower.
  pure subroutine set_levels(self, smallest, largest)
    class(search_t), intent(inout) :: self
    real(wp), intent(in) :: smallest, largest  !< radius [m]

    integer :: l, levels

    levels = min(max(nint(log(largest/smallest)/log(factor)), 1), most_levels)
    if (allocated(self%level)) deallocate (self%level)
    allocate (self%level(levels))
    do l = 1, levels
      self%level(l)%largest = merge(largest, smallest*(largest/smallest)**(real(l, wp)/levels), l == levels)
    end do
  end subroutine set_levels

  !> The order that sorts my parcels by level and bin.
  pure subroutine sort_own(self, parcels, skin, order)
    class(search_t), intent(inout) :: self
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: skin       !< [m]
    integer, intent(out) :: order(:)   !< (n)

    real(wp) :: box(3, 2)
    integer :: l, last(0:size(self%level))

    call sort_by_level(self%level, parcels%state, 0, order, last)
    self%box = box_around(parcels%state, order(1:min(1, parcels%n)))
    do l = 1, size(self%level)
      associate (level => self%level(l), columns => order(last(l - 1) + 1:last(l)))
        level%first = last(l - 1) + 1
        level%last = last(l)
        box = box_around(parcels%state, columns)
        if (size(columns) > 0) then
          self%box(:, 1) = min(self%box(:, 1), box(:, 1))
          self%box(:, 2) = max(self%box(:, 2), box(:, 2))
        end if
        call level%own%span(box(:, 1), box(:, 2), reach_of(level, level%largest, skin), bins_per_parcel*parcels%n)
        call level%own%sort(parcels%state, last(l - 1), columns)
      end associate
    end do
  end subroutine sort_own

  !> Columns from before + 1 on, level after level; those of level l are columns(last(l-1)+1:last(l)).
  pure subroutine sort_by_level(levels, state, before, columns, last)
    type(level_t), intent(in) :: levels(:)
    real(wp), intent(in), contiguous :: state(:,:)
    integer, intent(in) :: before
    integer, intent(out) :: columns(:), last(0:)

    integer :: l, i, level(size(columns)), next(size(levels))

    last = 0
    do i = 1, size(columns)
      level(i) = 1
      do l = 1, size(levels) - 1
        if (state(radius_row, before + i) > levels(l)%largest) level(i) = l + 1
      end do
      last(level(i)) = last(level(i)) + 1
    end do
    do l = 1, size(levels)
      next(l) = last(l - 1) + 1
      last(l) = last(l) + last(l - 1)
    end do
    do i = 1, size(columns)
      columns(next(level(i))) = before + i
      next(level(i)) = next(level(i)) + 1
    end do
  end subroutine sort_by_level

  !> Lowest and highest corner of what holds the centres of the given columns; a point if there are none [m].
  pure function box_around(state, columns) result(box)
    real(wp), intent(in), contiguous :: state(:,:)
    integer, intent(in) :: columns(:)
    real(wp) :: box(3, 2)

    integer :: i

    box = 0.0_wp
    if (size(columns) > 0) box = spread(state(1:3, columns(1)), 2, 2)
    do i = 2, size(columns)
      box(:, 1) = min(box(:, 1), state(1:3, columns(i)))
      box(:, 2) = max(box(:, 2), state(1:3, columns(i)))
    end do
  end function box_around

  !> How far the centres of a listed pair of a parcel and one of this level are apart at most [m].
  pure function reach_of(level, radius, skin) result(reach)
    type(level_t), intent(in) :: level
    real(wp), intent(in) :: radius, skin  !< [m]
    real(wp) :: reach

    reach = (radius + level%largest + skin)*wider
  end function reach_of

  !> List all pairs closer than the sum of their radii plus `skin`. My parcels are sorted, ghosts follow them.
  pure subroutine build(self, parcels, near_ghosts, skin, list)
    class(search_t), intent(inout) :: self
    type(parcels_t), intent(in) :: parcels
    logical, intent(in) :: near_ghosts(:)  !< (n) parcels that are looked at for pairs with ghosts
    real(wp), intent(in) :: skin           !< [m]
    type(contact_list_t), intent(inout) :: list

    integer :: i, l

    call list%start(parcels%n)
    if (allocated(self%place)) deallocate (self%place)
    allocate (self%place(4, parcels%n))
    do i = 1, parcels%n
      self%place(:, i) = parcels%state(1:4, i)
    end do
    call sort_ghosts(self, parcels, skin)
    do l = 1, size(self%level)
      do i = self%level(l)%first, self%level(l)%last
        call list_behind(self%level(l)%own, i, self%place, skin, list)
        call list_larger(self, l, i, skin, list)
        if (near_ghosts(i)) call list_ghosts(self, i, skin, list)
        list%first(i + 1) = list%entries + 1
      end do
    end do
    call list%note_rows()
  end subroutine build

  !> Append the partners of parcel i among those of its level behind it.
  pure subroutine list_behind(lattice, i, place, skin, list)
    type(bins_t), intent(in) :: lattice
    integer, intent(in) :: i
    real(wp), intent(in), contiguous :: place(:,:)
    real(wp), intent(in) :: skin
    type(contact_list_t), intent(inout) :: list

    integer :: bin(3), y, z, lo, hi, line

    bin = lattice%bin_of(place(1:3, i))
    associate (first => lattice%first, n => lattice%n)
      lo = max(bin(1) - 1, 0)
      hi = min(bin(1) + 1, n(1) - 1)
      do z = bin(3), min(bin(3) + 1, n(3) - 1)
        do y = merge(bin(2), max(bin(2) - 1, 0), z == bin(3)), min(bin(2) + 1, n(2) - 1)
          line = lattice%number_of(0, y, z)
          call append(place(:, i), place, max(first(line + lo), i + 1), first(line + hi + 1) - 1, skin, list)
        end do
      end do
    end associate
  end subroutine list_behind

  !> Append the partners of parcel i, of level l, in the levels of larger parcels.
  pure subroutine list_larger(self, l, i, skin, list)
    type(search_t), intent(in) :: self
    integer, intent(in) :: l, i
    real(wp), intent(in) :: skin
    type(contact_list_t), intent(inout) :: list

    integer :: m

    do m = l + 1, size(self%level)
      associate (level => self%level(m))
        if (level%last < level%first) cycle
        call list_around(level%own, self%place(:, i), reach_of(level, self%place(4, i), skin), self%place, skin, list)
      end associate
    end do
  end subroutine list_larger

  !> Append those places of a lattice that are near `here`.
  pure subroutine list_around(lattice, here, reach, place, skin, list)
    type(bins_t), intent(in) :: lattice
    real(wp), intent(in) :: here(4)  !< position and radius [m]
    real(wp), intent(in) :: reach    !< of the search [m]
    real(wp), intent(in), contiguous :: place(:,:)
    real(wp), intent(in) :: skin
    type(contact_list_t), intent(inout) :: list

    integer :: lo(3), hi(3), y, z, line

    lo = lattice%bin_of(here(1:3) - reach)
    hi = lattice%bin_of(here(1:3) + reach)
    do z = lo(3), hi(3)
      do y = lo(2), hi(2)
        line = lattice%number_of(0, y, z)
        call append(here, place, lattice%first(line + lo(1)), lattice%first(line + hi(1) + 1) - 1, skin, list)
      end do
    end do
  end subroutine list_around

  !> Append those of the places from `from` to `to` that are near; a place is its own column.
  pure subroutine append(here, place, from, to, skin, list)
    real(wp), intent(in) :: here(4)
    real(wp), intent(in), contiguous :: place(:,:)
    integer, intent(in) :: from, to
    real(wp), intent(in) :: skin
    type(contact_list_t), intent(inout) :: list

    integer :: j, m
    real(wp) :: reach, gap

    m = list%entries
    call list%reserve(m + to - from + 2)
    reach = here(4) + skin
    do j = from, to
      gap = (here(1) - place(1, j))**2 + (here(2) - place(2, j))**2 + (here(3) - place(3, j))**2 &
            - (reach + place(4, j))**2
      list%partner(m + 1) = j
      m = m + merge(1, 0, gap < 0.0_wp)
    end do
    list%entries = m
  end subroutine append

  !> Sort the ghosts of each level into bins over my parcels of all levels; those beyond count to the outermost bins.
  pure subroutine sort_ghosts(self, parcels, skin)
    type(search_t), intent(inout) :: self
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: skin

    integer :: l, k, last(0:size(self%level))

    if (allocated(self%ghost)) deallocate (self%ghost, self%column)
    allocate (self%ghost(4, parcels%n_ghost), self%column(parcels%n_ghost))
    self%level%n_ghosts = 0
    if (parcels%n_ghost == 0) return
    call sort_by_level(self%level, parcels%state, parcels%n, self%column, last)
    do l = 1, size(self%level)
      associate (level => self%level(l), columns => self%column(last(l - 1) + 1:last(l)))
        level%n_ghosts = size(columns)
        call level%ghosts%span(self%box(:, 1), self%box(:, 2), reach_of(level, level%largest, skin), bins_per_parcel*parcels%n)
        call level%ghosts%sort(parcels%state, last(l - 1), columns)
      end associate
    end do
    do k = 1, parcels%n_ghost
      self%ghost(:, k) = parcels%state(1:4, self%column(k))
    end do
  end subroutine sort_ghosts

  !> Append the ghosts near parcel i.
  pure subroutine list_ghosts(self, i, skin, list)
    type(search_t), intent(in) :: self
    integer, intent(in) :: i
    real(wp), intent(in) :: skin
    type(contact_list_t), intent(inout) :: list

    integer :: m, before

    before = list%entries
    associate (here => self%place(:, i))
      do m = 1, size(self%level)
        if (self%level(m)%n_ghosts == 0) cycle
        call list_around(self%level(m)%ghosts, here, reach_of(self%level(m), here(4), skin), self%ghost, skin, list)
      end do
    end associate
    list%partner(before + 1:list%entries) = self%column(list%partner(before + 1:list%entries))
  end subroutine list_ghosts

end module neighbours
