!> The two layers of cells around a rank's box of gas, kept equal to the cells of the neighbours.
!>
!> One direction after the other, each with the halos of the others included, so that edges and corners are right.
!> Halos beyond a face of the domain that is not periodic belong to the boundary conditions and stay as they are.
module halo
  use boxes, only: boxes_t
  use kinds, only: wp
  use mpi_f08, only: MPI_Comm, MPI_Request, MPI_Irecv, MPI_Isend, MPI_Waitall, MPI_F_sync_reg, &
    MPI_DOUBLE_PRECISION, MPI_STATUSES_IGNORE, MPI_REQUEST_NULL
  implicit none
  private
  public :: halo_t, new_halo

  integer, parameter :: width = 2      !< layers of cells
  integer, parameter :: low = 1, high = 2
  integer, parameter :: at_once = 4    !< fields the buffers hold before they first have to grow

  type :: halo_t
    private
    type(MPI_Comm) :: handle
    integer :: rank
    integer :: n(3)                              !< cells of my box
    integer :: neighbour(2, 3)                   !< rank below and above, or -1
    real(wp), allocatable :: outgoing(:,:)       !< (cells of the largest side x fields, 2) packed for below, above
    real(wp), allocatable :: incoming(:,:)
  contains
    procedure :: exchange
    procedure :: exchange_many
  end type halo_t

contains

  !> The exchange for fields over the box of this rank.
  function new_halo(boxes) result(halo)
    type(boxes_t), intent(in) :: boxes
    type(halo_t) :: halo

    halo%handle = boxes%comm%handle
    halo%rank = boxes%comm%rank
    halo%n = boxes%n
    halo%neighbour = boxes%neighbour
    call reserve(halo, at_once)
  end function new_halo

  !> Fill the halo of one field, (-1:n1+2, -1:n2+2, -1:n3+2).
  subroutine exchange(self, f)
    class(halo_t), intent(inout) :: self
    real(wp), intent(inout), contiguous :: f(-1:, -1:, -1:)

    call exchange_fields(self, 1, f)
  end subroutine exchange

  !> Fill the halos of several fields, (-1:n1+2, -1:n2+2, -1:n3+2, field), with one message per side.
  subroutine exchange_many(self, f)
    class(halo_t), intent(inout) :: self
    real(wp), intent(inout), contiguous :: f(-1:, -1:, -1:, :)

    call exchange_fields(self, size(f, 4), f)
  end subroutine exchange_many

  subroutine exchange_fields(self, fields, f)
    class(halo_t), intent(inout) :: self
    integer, intent(in) :: fields
    real(wp), intent(inout) :: f(1 - width:self%n(1) + width, 1 - width:self%n(2) + width, &
                                 1 - width:self%n(3) + width, fields)

    integer :: a

    call reserve(self, fields)
    do a = 1, 3
      if (all(self%neighbour(:, a) == self%rank)) then
        call wrap(a, self%n, fields, f)
      else if (any(self%neighbour(:, a) >= 0)) then
        call swap(self, a, fields, f)
      end if
    end do
  end subroutine exchange_fields

  !> Let the buffers hold the largest side of so many fields.
  subroutine reserve(self, fields)
    class(halo_t), intent(inout) :: self
    integer, intent(in) :: fields

    integer :: whole(3), most

    whole = self%n + 2*width
    most = width*fields*maxval(product(whole)/whole)
    if (allocated(self%outgoing)) then
      if (size(self%outgoing, 1) >= most) return
      deallocate (self%outgoing, self%incoming)
    end if
    allocate (self%outgoing(most, 2), self%incoming(most, 2))
  end subroutine reserve

  !> A periodic direction that is not cut: the box is its own neighbour.
  !> A box thinner than the halo is repeated, hence modulo.
  subroutine wrap(a, n, fields, f)
    integer, intent(in) :: a, n(3), fields
    real(wp), intent(inout) :: f(1 - width:n(1) + width, 1 - width:n(2) + width, 1 - width:n(3) + width, fields)

    integer :: to, from, layer

    do layer = 1, 2*width
      to = merge(layer - width, n(a) + layer - width, layer <= width)
      from = 1 + modulo(to - 1, n(a))
      select case (a)
      case (1)
        f(to, :, :, :) = f(from, :, :, :)
      case (2)
        f(:, to, :, :) = f(:, from, :, :)
      case default
        f(:, :, to, :) = f(:, :, from, :)
      end select
    end do
  end subroutine wrap

  !> Exchange the sides of one direction with other ranks.
  subroutine swap(self, a, fields, f)
    class(halo_t), intent(inout) :: self
    integer, intent(in) :: a, fields
    real(wp), intent(inout) :: f(1 - width:self%n(1) + width, 1 - width:self%n(2) + width, &
                                 1 - width:self%n(3) + width, fields)

    type(MPI_Request) :: request(4)
    integer :: side, length, whole(3), inner(2), outer(2)

    whole = self%n + 2*width
    length = width*fields*(product(whole)/whole(a))
    inner = [1, self%n(a) - width + 1]
    outer = [1 - width, self%n(a) + 1]
    request = MPI_REQUEST_NULL
    do side = low, high
      if (self%neighbour(side, a) < 0) cycle
      call MPI_Irecv(self%incoming(1, side), length, MPI_DOUBLE_PRECISION, self%neighbour(side, a), side, &
                     self%handle, request(side))
    end do
    do side = low, high
      if (self%neighbour(side, a) < 0) cycle
      call pack_layers(a, inner(side), self%n, fields, f, self%outgoing(:, side))
      ! what leaves through my low side arrives at the receiver's high side
      call MPI_Isend(self%outgoing(1, side), length, MPI_DOUBLE_PRECISION, self%neighbour(side, a), 3 - side, &
                     self%handle, request(2 + side))
    end do
    call MPI_Waitall(4, request, MPI_STATUSES_IGNORE)
    call MPI_F_sync_reg(self%incoming)
    call MPI_F_sync_reg(self%outgoing)
    do side = low, high
      if (self%neighbour(side, a) < 0) cycle
      call unpack_layers(a, outer(side), self%n, fields, self%incoming(:, side), f)
    end do
  end subroutine swap

  !> Copy the layers first, first + 1 across direction a into a buffer.
  pure subroutine pack_layers(a, first, n, fields, f, buffer)
    integer, intent(in) :: a, first, n(3), fields
    real(wp), intent(in) :: f(1 - width:n(1) + width, 1 - width:n(2) + width, 1 - width:n(3) + width, fields)
    real(wp), intent(inout) :: buffer(:)

    integer :: i, j, k, m, at, from(3), to(3)

    call layer_bounds(a, first, n, from, to)
    at = 0
    do m = 1, fields
      do k = from(3), to(3)
        do j = from(2), to(2)
          do i = from(1), to(1)
            at = at + 1
            buffer(at) = f(i, j, k, m)
          end do
        end do
      end do
    end do
  end subroutine pack_layers

  !> Copy a buffer into the layers first, first + 1 across direction a.
  pure subroutine unpack_layers(a, first, n, fields, buffer, f)
    integer, intent(in) :: a, first, n(3), fields
    real(wp), intent(in) :: buffer(:)
    real(wp), intent(inout) :: f(1 - width:n(1) + width, 1 - width:n(2) + width, 1 - width:n(3) + width, fields)

    integer :: i, j, k, m, at, from(3), to(3)

    call layer_bounds(a, first, n, from, to)
    at = 0
    do m = 1, fields
      do k = from(3), to(3)
        do j = from(2), to(2)
          do i = from(1), to(1)
            at = at + 1
            f(i, j, k, m) = buffer(at)
          end do
        end do
      end do
    end do
  end subroutine unpack_layers

  !> Index bounds of two layers across direction a, over the whole of the other directions.
  pure subroutine layer_bounds(a, first, n, from, to)
    integer, intent(in) :: a, first, n(3)
    integer, intent(out) :: from(3), to(3)

    from = 1 - width
    to = n + width
    from(a) = first
    to(a) = first + width - 1
  end subroutine layer_bounds

end module halo
