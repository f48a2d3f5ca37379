!> Cell fields carried between the boxes of the gas and the windows of the parcels.
!>
!> The plan is made once per change of the tiles: every rank asks the owners for the cells its window wants. Then
!> `gather` copies cells to every window that wants them, `scatter_add` returns what was added to them and sums it
!> in the box, always in the same order. A cell and its periodic images are one cell. Neither allocates anything.
module transfer
  use boxes, only: boxes_t
  use kinds, only: wp
  use mpi_f08, only: MPI_Comm, MPI_Request, MPI_Irecv, MPI_Isend, MPI_Waitall, MPI_F_sync_reg, MPI_INTEGER, &
    MPI_DOUBLE_PRECISION, MPI_STATUSES_IGNORE
  use window, only: window_t
  implicit none
  private
  public :: transfer_t, new_transfer

  integer, parameter :: tag_plan = 41, tag_cells = 42

  !> The cells one rank shares with each of the others, rank after rank.
  type :: shares_t
    integer, allocatable :: rank(:)   !< (peers) the other rank
    integer, allocatable :: first(:)  !< (peers + 1) where its cells begin in `cell`
    integer, allocatable :: cell(:)   !< cells of my box or of my window, counted from 1
  end type shares_t

  type :: transfer_t
    private
    type(MPI_Comm) :: handle
    integer :: box_cells, window_cells
    integer, allocatable :: mine(:,:)             !< (2,cells) box and window cell of what stays on this rank
    type(shares_t) :: box                         !< cells of my box in the windows of others
    type(shares_t) :: window                      !< cells of my window in the boxes of others
    real(wp), allocatable :: box_buffer(:)        !< (components x cells of box%cell)
    real(wp), allocatable :: window_buffer(:)     !< (components x cells of window%cell)
    type(MPI_Request), allocatable :: request(:)
  contains
    procedure :: gather
    procedure :: scatter_add
  end type transfer_t

contains

  !> Make the plan; all ranks together.
  subroutine new_transfer(boxes, window, components, transfer)
    type(boxes_t), intent(in) :: boxes
    type(window_t), intent(in) :: window
    integer, intent(in) :: components           !< most components a field will have
    type(transfer_t), intent(out) :: transfer

    integer, allocatable :: wish(:,:), order(:,:)
    integer :: i

    transfer%handle = boxes%comm%handle
    transfer%box_cells = product(boxes%n)
    transfer%window_cells = window%cells()
    call sort_by_owner(boxes, window, transfer)
    associate (asked => transfer%box%cell, asking => transfer%window%cell)
      allocate (wish(3, size(asking)), order(3, size(asked)))
      do i = 1, size(asking)
        wish(:, i) = window%cell_at(asking(i))
      end do
      call swap_wishes(transfer, wish, order)
      do i = 1, size(asked)
        asked(i) = cell_of_box(boxes, order(:, i))
      end do
      allocate (transfer%box_buffer(components*size(asked)), transfer%window_buffer(components*size(asking)))
    end associate
    allocate (transfer%request(size(transfer%box%rank) + size(transfer%window%rank)))
  end subroutine new_transfer

  !> Where in my box, counted from 1 with x fastest, a cell of the whole grid is.
  pure function cell_of_box(boxes, cell) result(index)
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: cell(3)
    integer :: index

    associate (at => cell - boxes%lo)
      index = 1 + at(1) + boxes%n(1)*(at(2) + boxes%n(2)*at(3))
    end associate
  end function cell_of_box

  !> Sort the wanted cells of my window by the rank that owns them, and make room for what others want of my box.
  subroutine sort_by_owner(boxes, window, transfer)
    type(boxes_t), intent(in) :: boxes
    type(window_t), intent(in) :: window
    type(transfer_t), intent(inout) :: transfer

    integer, dimension(0:boxes%comm%size - 1) :: counts, last
    integer, allocatable :: owner(:)
    integer :: i, me, n_mine

    me = boxes%comm%rank
    allocate (owner(window%cells()), source=-1)
    counts = 0
    do i = 1, size(owner)
      if (.not. window%wanted(i)) cycle
      owner(i) = boxes%owner_of(window%cell_at(i))
      counts(owner(i)) = counts(owner(i)) + 1
    end do
    allocate (transfer%mine(2, counts(me)))
    counts(me) = 0
    call list_peers(counts, transfer%window)
    call list_peers(boxes%comm%swap_counts(counts), transfer%box)
    last = 0
    last(transfer%window%rank) = transfer%window%first(:size(transfer%window%rank)) - 1
    n_mine = 0
    do i = 1, size(owner)
      if (owner(i) == me) then
        n_mine = n_mine + 1
        transfer%mine(:, n_mine) = [cell_of_box(boxes, window%cell_at(i)), i]
      else if (owner(i) >= 0) then
        last(owner(i)) = last(owner(i)) + 1
        transfer%window%cell(last(owner(i))) = i
      end if
    end do
  end subroutine sort_by_owner

  !> The ranks with a positive count, in rising order, and room for so many cells of each.
  pure subroutine list_peers(counts, shares)
    integer, intent(in) :: counts(0:)  !< cells shared with each rank
    type(shares_t), intent(out) :: shares

    integer :: i

    shares%rank = pack([(i, i=0, size(counts) - 1)], counts > 0)
    allocate (shares%first(size(shares%rank) + 1))
    shares%first(1) = 1
    do i = 1, size(shares%rank)
      shares%first(i + 1) = shares%first(i) + counts(shares%rank(i))
    end do
    allocate (shares%cell(sum(counts)), source=0)
  end subroutine list_peers

  !> Send the cells wished for to their owners.
  subroutine swap_wishes(transfer, wish, order)
    type(transfer_t), intent(in) :: transfer
    integer, intent(inout) :: wish(:,:)   !< (3,cells) of the whole grid, for the owners
    integer, intent(inout) :: order(:,:)  !< (3,cells) the same, from those who want mine

    type(MPI_Request) :: request(size(transfer%box%rank) + size(transfer%window%rank))
    integer :: p, n

    associate (from => transfer%box, to => transfer%window)
      n = size(from%rank)
      do p = 1, n
        call MPI_Irecv(order(1, from%first(p)), 3*(from%first(p + 1) - from%first(p)), MPI_INTEGER, from%rank(p), &
                       tag_plan, transfer%handle, request(p))
      end do
      do p = 1, size(to%rank)
        call MPI_Isend(wish(1, to%first(p)), 3*(to%first(p + 1) - to%first(p)), MPI_INTEGER, to%rank(p), &
                       tag_plan, transfer%handle, request(n + p))
      end do
    end associate
    call MPI_Waitall(size(request), request, MPI_STATUSES_IGNORE)
    call MPI_F_sync_reg(order)
    call MPI_F_sync_reg(wish)
  end subroutine swap_wishes

  !> Copy the wanted cells of a field from the boxes into the windows; cells not wanted stay as they are.
  subroutine gather(self, components, box, window)
    class(transfer_t), intent(inout) :: self
    integer, intent(in) :: components
    real(wp), intent(in) :: box(components, self%box_cells)           !< any unit
    real(wp), intent(inout) :: window(components, self%window_cells)  !< the same

    integer :: i

    call take_cells(components, self%box%cell, box, self%box_buffer)
    call start(self%handle, components, self%box, self%box_buffer, self%window, self%window_buffer, self%request)
    do i = 1, size(self%mine, 2)
      window(:, self%mine(2, i)) = box(:, self%mine(1, i))
    end do
    call complete(self)
    call put_cells(components, self%window%cell, self%window_buffer, window)
  end subroutine gather

  !> Add the wanted cells of the windows to the field over the boxes: own cells first, then rank by rank.
  subroutine scatter_add(self, components, window, box)
    class(transfer_t), intent(inout) :: self
    integer, intent(in) :: components
    real(wp), intent(in) :: window(components, self%window_cells)  !< any unit
    real(wp), intent(inout) :: box(components, self%box_cells)     !< the same

    integer :: i

    call take_cells(components, self%window%cell, window, self%window_buffer)
    call start(self%handle, components, self%window, self%window_buffer, self%box, self%box_buffer, self%request)
    do i = 1, size(self%mine, 2)
      box(:, self%mine(1, i)) = box(:, self%mine(1, i)) + window(:, self%mine(2, i))
    end do
    call complete(self)
    call add_cells(components, self%box%cell, self%box_buffer, box)
  end subroutine scatter_add

  !> Start to send one buffer and to receive the other.
  subroutine start(handle, components, give, outgoing, take, incoming, request)
    type(MPI_Comm), intent(in) :: handle
    integer, intent(in) :: components
    type(shares_t), intent(in) :: give, take
    real(wp), intent(inout) :: outgoing(components, *), incoming(components, *)
    type(MPI_Request), intent(inout) :: request(:)

    integer :: p, n

    n = size(take%rank)
    do p = 1, n
      call MPI_Irecv(incoming(1, take%first(p)), components*(take%first(p + 1) - take%first(p)), &
                     MPI_DOUBLE_PRECISION, take%rank(p), tag_cells, handle, request(p))
    end do
    do p = 1, size(give%rank)
      call MPI_Isend(outgoing(1, give%first(p)), components*(give%first(p + 1) - give%first(p)), &
                     MPI_DOUBLE_PRECISION, give%rank(p), tag_cells, handle, request(n + p))
    end do
  end subroutine start

  !> Wait until everything started has come and gone.
  subroutine complete(self)
    class(transfer_t), intent(inout) :: self

    call MPI_Waitall(size(self%request), self%request, MPI_STATUSES_IGNORE)
    call MPI_F_sync_reg(self%box_buffer)
    call MPI_F_sync_reg(self%window_buffer)
  end subroutine complete

  pure subroutine take_cells(components, cell, field, buffer)
    integer, intent(in) :: components, cell(:)
    real(wp), intent(in) :: field(components, *)
    real(wp), intent(inout) :: buffer(components, *)

    integer :: i

    do i = 1, size(cell)
      buffer(:, i) = field(:, cell(i))
    end do
  end subroutine take_cells

  pure subroutine put_cells(components, cell, buffer, field)
    integer, intent(in) :: components, cell(:)
    real(wp), intent(in) :: buffer(components, *)
    real(wp), intent(inout) :: field(components, *)

    integer :: i

    do i = 1, size(cell)
      field(:, cell(i)) = buffer(:, i)
    end do
  end subroutine put_cells

  pure subroutine add_cells(components, cell, buffer, field)
    integer, intent(in) :: components, cell(:)
    real(wp), intent(in) :: buffer(components, *)
    real(wp), intent(inout) :: field(components, *)

    integer :: i

    do i = 1, size(cell)
      field(:, cell(i)) = field(:, cell(i)) + buffer(:, i)
    end do
  end subroutine add_cells

end module transfer
