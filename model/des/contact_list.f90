!> Pairs that touch or may touch before the list is made again.
!>
!> Row i holds the partners of parcel i: own parcels with a higher column, then ghosts. They are entries first(i)
!> to first(i+1)-1. Loops over all pairs read the row from `row`: an inner loop over a few partners ends at
!> another place each time, which no processor foresees (14 % of the contact loop).
module contact_list
  implicit none
  private
  public :: contact_list_t, stretch_rows, columns_at_once

  integer, parameter :: stretch_rows = 1024  !< swept, then moved: their parcels, partners and pairs stay in the L2 cache

  type :: contact_list_t
    integer :: rows = 0                   !< own parcels, or parcels near walls
    integer :: entries = 0                !< entries in use
    integer :: window = 0                 !< own parcels that a stretch of rows may need, see columns_at_once
    integer, allocatable :: first(:)      !< (rows+1 at least)
    integer, allocatable :: row(:)        !< (entries at least) the row of each entry
    integer, allocatable :: partner(:)    !< (entries at least) column of the partner
  contains
    procedure :: start
    procedure :: reserve
    procedure :: note_rows
  end type contact_list_t

contains

  !> An empty list of the given number of rows.
  pure subroutine start(self, rows)
    class(contact_list_t), intent(inout) :: self
    integer, intent(in) :: rows

    self%rows = rows
    self%entries = 0
    if (allocated(self%first)) then
      if (size(self%first) <= rows) deallocate (self%first)
    end if
    if (.not. allocated(self%first)) allocate (self%first(rows + rows/4 + 2))
    self%first(1) = 1
    if (.not. allocated(self%partner)) allocate (self%partner(6*rows + 64))
  end subroutine start

  !> Room for at least so many entries in `partner`.
  pure subroutine reserve(self, entries)
    class(contact_list_t), intent(inout) :: self
    integer, intent(in) :: entries

    integer, allocatable :: larger(:)

    if (entries <= size(self%partner)) return
    allocate (larger(entries + entries/4))
    larger(1:self%entries) = self%partner(1:self%entries)
    call move_alloc(larger, self%partner)
  end subroutine reserve

  !> Once all rows are there: which row each entry is in.
  pure subroutine note_rows(self)
    class(contact_list_t), intent(inout) :: self

    integer :: i

    if (allocated(self%row)) then
      if (size(self%row) < self%entries) deallocate (self%row)
    end if
    if (.not. allocated(self%row)) allocate (self%row(self%entries + self%entries/8 + 8))
    do i = 1, self%rows
      self%row(self%first(i):self%first(i + 1) - 1) = i
    end do
    self%window = columns_at_once(self%row(1:self%entries), self%partner(1:self%entries), self%rows, 1)
  end subroutine note_rows

  !> The most columns from the first row of a stretch to the last partner in it, if pairs are taken `together` at a time.
  pure function columns_at_once(row, partner, rows, together) result(columns)
    integer, intent(in) :: row(:), partner(:)  !< of pairs, rows ascending
    integer, intent(in) :: rows                !< own parcels; other partners do not count
    integer, intent(in) :: together
    integer :: columns

    integer :: k, before

    columns = stretch_rows
    do k = 1, size(row)
      before = stretch_rows*((row(k - modulo(k - 1, together)) - 1)/stretch_rows)
      columns = max(columns, merge(partner(k), row(k), partner(k) <= rows) - before)
    end do
  end function columns_at_once

end module contact_list
