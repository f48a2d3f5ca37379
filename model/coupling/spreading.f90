!> Spreading what parcels give to the gas over more cells than they touch, and taking what they see from as many.
!>
!> In each direction in turn amounts in cells are spread as by diffusion, K(j,i) of module diffusion_kernel, and what parcels
!> see is the mean over the same cells:
!>
!>   given   q'_i = sum over j of K(j,i) q_j,        taken   f'_i = sum over j of K(i,j) f_j.                   (1)
!>
!> So sum of q' = sum of q, f' = f where f is uniform, and sum over i of q'_i f_i = sum over j of q_j f'_j, to round-off:
!> what the gas gets is what the parcels give. The directions commute. Nothing goes through the faces of the domain,
!> periodic ones apart.
!>
!> A box gathers the cells of its rows, however far the kernel reaches, and adds them up in the same order on any number
!> of ranks. Diffusion in steps would need one exchange for each; implicit steps, solved to a tolerance, would be neither
!> positive nor conservative nor the same both ways to round-off.
module spreading
  use boxes, only: boxes_t
  use diffusion_kernel, only: kernel_row, kernel_reach
  use kinds, only: wp
  use mesh, only: mesh_t
  use transfer, only: transfer_t, new_transfer
  use window, only: window_t, range_of_cells
  implicit none
  private
  public :: spreading_t

  integer, parameter :: strip = 8  !< numbers added up together

  !> The kernel along one direction.
  type :: direction_t
    logical :: active = .false.             !< false: one cell across, or the mapping alone is so wide
    integer :: reach                        !< cells
    integer :: lo, hi                       !< cells gathered, counted in my box from 1
    type(transfer_t) :: transfer            !< fills these
    real(wp), allocatable :: given(:,:)     !< (-reach:reach,n) K(i + m,i) of my cells i
    real(wp), allocatable :: taken(:,:)     !< (-reach:reach,n) K(i,i + m)
    real(wp), allocatable :: cells(:)       !< (components x cells)
  end type direction_t

  type :: spreading_t
    private
    integer :: n(3)  !< cells of my box
    type(direction_t) :: direction(3)
  contains
    procedure :: create
    procedure :: give
    procedure :: take
  end type spreading_t

contains

  !> All ranks together.
  subroutine create(self, boxes, mesh, width, mapped, components)
    class(spreading_t), intent(inout) :: self
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    real(wp), intent(in) :: width        !< standard deviation in each direction, mapping included [m]
    real(wp), intent(in) :: mapped       !< variance of the mapping over the width of a cell squared [-]
    integer, intent(in) :: components    !< most components a field will have

    type(window_t) :: window
    integer :: a, lo(3), hi(3)

    self%n = boxes%n
    do a = 1, 3
      if (boxes%cells(a) == 1 .or. mapped*mesh%finest(a)**2 >= width**2) cycle
      associate (direction => self%direction(a))
        direction%active = .true.
        call find_rows(direction, mesh%axis(a)%width(1:mesh%n(a)), mesh%periodic(a), width, mapped, &
                       boxes%lo(a), boxes%n(a))
        lo = boxes%lo
        hi = boxes%hi
        lo(a) = lo(a) + direction%lo - 1
        hi(a) = lo(a) + direction%hi - direction%lo
        window = range_of_cells(boxes%cells, boxes%periodic, lo, hi)
        call new_transfer(boxes, window, components, direction%transfer)
        allocate (direction%cells(components*window%cells()), source=0.0_wp)
      end associate
    end do
  end subroutine create

  !> The rows of K for the cells of my box, and the cells they need.
  pure subroutine find_rows(direction, h, periodic, width, mapped, first, n)
    type(direction_t), intent(inout) :: direction
    real(wp), intent(in) :: h(:)        !< widths of all cells [m]
    logical, intent(in) :: periodic
    real(wp), intent(in) :: width       !< [m]
    real(wp), intent(in) :: mapped      !< [-]
    integer, intent(in) :: first, n     !< cells of my box

    integer :: i, m, j

    associate (reach => direction%reach)
      reach = kernel_reach(h, width)
      direction%lo = 1 - reach
      direction%hi = n + reach
      if (.not. periodic) direction%lo = max(direction%lo, 2 - first)
      if (.not. periodic) direction%hi = min(direction%hi, size(h) + 1 - first)
      allocate (direction%taken(-reach:reach, n), direction%given(-reach:reach, n))
      do i = 1, n
        direction%taken(:, i) = kernel_row(h, periodic, width, mapped, first + i - 1, reach)
        do m = -reach, reach
          j = modulo(first + i + m - 2, size(h)) + 1
          direction%given(m, i) = direction%taken(m, i)*(h(first + i - 1)/h(j))
        end do
      end do
    end associate
  end subroutine find_rows

  !> Spread amounts over cells; all ranks together.
  subroutine give(self, components, amount)
    class(spreading_t), intent(inout) :: self
    integer, intent(in) :: components
    real(wp), intent(inout) :: amount(components, product(self%n))  !< in the cells of my box, any unit

    integer :: a

    do a = 1, 3
      if (.not. self%direction(a)%active) cycle
      associate (direction => self%direction(a))
        call direction%transfer%gather(components, amount, direction%cells)
        call add_up(components*product(self%n(:a - 1)), product(self%n(a + 1:)), direction, direction%given, &
                    direction%cells, amount)
      end associate
    end do
  end subroutine give

  !> Means of a field over the cells that parcels see from each; all ranks together.
  subroutine take(self, components, field)
    class(spreading_t), intent(inout) :: self
    integer, intent(in) :: components
    real(wp), intent(inout) :: field(components, product(self%n))  !< in the cells of my box, any unit

    integer :: a

    do a = 1, 3
      if (.not. self%direction(a)%active) cycle
      associate (direction => self%direction(a))
        call direction%transfer%gather(components, field, direction%cells)
        call add_up(components*product(self%n(:a - 1)), product(self%n(a + 1:)), direction, direction%taken, &
                    direction%cells, field)
      end associate
    end do
  end subroutine take

  !> One of the sums (1) along one direction.
  pure subroutine add_up(before, after, direction, kernel, cells, sums)
    integer, intent(in) :: before  !< numbers that belong to one cell of a row: components and the directions before
    integer, intent(in) :: after   !< and of the directions after
    type(direction_t), intent(in) :: direction
    real(wp), intent(in) :: kernel(-direction%reach:, :)
    real(wp), intent(in) :: cells(before, direction%lo:direction%hi, after)
    real(wp), intent(inout) :: sums(before, size(kernel, 2), after)

    real(wp) :: total(strip)
    integer :: i, m, k, b, first, last

    do k = 1, after
      do i = 1, size(kernel, 2)
        first = max(-direction%reach, direction%lo - i)
        last = min(direction%reach, direction%hi - i)
        do b = 1, before - strip + 1, strip
          total = 0.0_wp
          do m = first, last
            total = total + kernel(m, i)*cells(b:b + strip - 1, i + m, k)
          end do
          sums(b:b + strip - 1, i, k) = total
        end do
        do b = before - modulo(before, strip) + 1, before
          total(1) = 0.0_wp
          do m = first, last
            total(1) = total(1) + kernel(m, i)*cells(b, i + m, k)
          end do
          sums(b, i, k) = total(1)
        end do
      end do
    end do
  end subroutine add_up

end module spreading
