!> Which pairs of parcels may touch before the list is made again.
module neighbours
  use bins, only: bins_t
  use contact_list, only: contact_list_t
  use kinds, only: wp
  use parcels, only: parcels_t
  implicit none
  private
  public :: search_t

  !> The lattice for my parcels and the same one for ghosts.
  type :: search_t
    type(bins_t) :: own, ghosts
    logical, allocatable :: near_ghosts(:)  !< whether a bin or one of its 26 neighbours holds a ghost
  contains
    procedure :: sort_own
    procedure :: build
  end type search_t

contains

  !> The order that sorts my parcels by bins of at least `range`.
  subroutine sort_own(self, parcels, range, order)
    class(search_t), intent(inout) :: self
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: range      !< [m]
    integer, intent(out) :: order(:)   !< (n)

    real(wp) :: lower(3), upper(3)
    integer :: a

    lower = 0.0_wp
    upper = 0.0_wp
    if (parcels%n > 0) then
      do a = 1, 3
        lower(a) = minval(parcels%state(a, 1:parcels%n))
        upper(a) = maxval(parcels%state(a, 1:parcels%n))
      end do
    end if
    call self%own%span(lower, upper, range, parcels%n)
    call self%own%sort(parcels%state, 0, order)
  end subroutine sort_own

  !> List all pairs closer than the sum of their radii plus `skin`. My parcels are sorted, ghosts follow them.
  subroutine build(self, parcels, skin, list)
    class(search_t), intent(inout) :: self
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: skin  !< [m]
    type(contact_list_t), intent(inout) :: list

    real(wp), allocatable :: place(:,:), ghost_place(:,:)
    integer, allocatable :: column(:)
    integer :: i

    call list%start(parcels%n)
    allocate (place(4, parcels%n))
    do i = 1, parcels%n
      place(:, i) = parcels%state(1:4, i)
    end do
    call sort_ghosts(self, parcels, ghost_place, column)
    do i = 1, parcels%n
      call list_row(self, i, place, skin, list)
      if (parcels%n_ghost > 0) call list_ghosts(self, place(:, i), ghost_place, column, skin, list)
      list%first(i + 1) = list%entries + 1
    end do
    call list%note_rows()
  end subroutine build

  !> Append the partners of parcel i among my parcels behind it.
  pure subroutine list_row(self, i, place, skin, list)
    type(search_t), intent(in) :: self
    integer, intent(in) :: i
    real(wp), intent(in), contiguous :: place(:,:)
    real(wp), intent(in) :: skin
    type(contact_list_t), intent(inout) :: list

    integer :: bin(3), y, z, lo, hi, line

    bin = self%own%bin_of(place(1:3, i))
    associate (first => self%own%first, n => self%own%n)
      lo = max(bin(1) - 1, 0)
      hi = min(bin(1) + 1, n(1) - 1)
      do z = bin(3), min(bin(3) + 1, n(3) - 1)
        do y = merge(bin(2), max(bin(2) - 1, 0), z == bin(3)), min(bin(2) + 1, n(2) - 1)
          line = 1 + n(1)*(y + n(2)*z)
          call append(place(:, i), place, max(first(line + lo), i + 1), first(line + hi + 1) - 1, skin, list)
        end do
      end do
    end associate
  end subroutine list_row

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

  !> Sort the ghosts into the lattice of my parcels; those beyond it count to its outermost bins.
  subroutine sort_ghosts(self, parcels, place, column)
    type(search_t), intent(inout) :: self
    type(parcels_t), intent(in) :: parcels
    real(wp), allocatable, intent(out) :: place(:,:)   !< (4, n_ghost) sorted
    integer, allocatable, intent(out) :: column(:)     !< (n_ghost) their columns

    integer :: k, y, z, line
    integer :: bin(3), lo(3), hi(3)

    allocate (place(4, parcels%n_ghost), column(parcels%n_ghost))
    if (parcels%n_ghost == 0) return
    self%ghosts%lower = self%own%lower
    self%ghosts%per_edge = self%own%per_edge
    self%ghosts%n = self%own%n
    self%ghosts%first = self%own%first
    call self%ghosts%sort(parcels%state, parcels%n, column)
    column = column + parcels%n
    if (allocated(self%near_ghosts)) deallocate (self%near_ghosts)
    allocate (self%near_ghosts(size(self%own%first)))
    self%near_ghosts = .false.
    do k = 1, parcels%n_ghost
      place(:, k) = parcels%state(1:4, column(k))
      bin = self%own%bin_of(place(1:3, k))
      lo = max(bin - 1, 0)
      hi = min(bin + 1, self%own%n - 1)
      do z = lo(3), hi(3)
        do y = lo(2), hi(2)
          line = 1 + self%own%n(1)*(y + self%own%n(2)*z)
          self%near_ghosts(line + lo(1):line + hi(1)) = .true.
        end do
      end do
    end do
  end subroutine sort_ghosts

  !> Append the ghosts near a parcel.
  pure subroutine list_ghosts(self, here, place, column, skin, list)
    type(search_t), intent(in) :: self
    real(wp), intent(in) :: here(4)
    real(wp), intent(in), contiguous :: place(:,:)
    integer, intent(in) :: column(:)
    real(wp), intent(in) :: skin
    type(contact_list_t), intent(inout) :: list

    integer :: bin(3), y, z, lo, hi, line, before

    associate (first => self%ghosts%first, n => self%ghosts%n)
      bin = self%ghosts%bin_of(here(1:3))
      if (.not. self%near_ghosts(1 + bin(1) + n(1)*(bin(2) + n(2)*bin(3)))) return
      before = list%entries
      lo = max(bin(1) - 1, 0)
      hi = min(bin(1) + 1, n(1) - 1)
      do z = max(bin(3) - 1, 0), min(bin(3) + 1, n(3) - 1)
        do y = max(bin(2) - 1, 0), min(bin(2) + 1, n(2) - 1)
          line = 1 + n(1)*(y + n(2)*z)
          call append(here, place, first(line + lo), first(line + hi + 1) - 1, skin, list)
        end do
      end do
    end associate
    list%partner(before + 1:list%entries) = column(list%partner(before + 1:list%entries))
  end subroutine list_ghosts

end module neighbours
