!> Spreading by diffusion: the kernel against Bessel functions and images, and what boxes make of it on any number of ranks.
program test_spreading
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use diffusion_kernel, only: kernel_row, kernel_reach
  use kinds, only: wp
  use mesh, only: mesh_t, new_uniform_mesh
  use outcome, only: outcome_t
  use spreading, only: spreading_t
  implicit none

  integer, parameter :: components = 3
  type(communicator_t) :: comm

  call start_ranks(comm)
  if (comm%is_root()) then
    call check_exact(0.1_wp)
    call check_exact(1.0_wp)
    call check_exact(3.3_wp)
    call check_exact(25.0_wp)
    call check_walls()
    call check_graded()
  end if
  call check_boxes([8, 12, 6], [.false., .false., .false.], 'walls')
  call check_boxes([8, 12, 6], [.true., .true., .true.], 'periodic')
  call check_boxes([5, 1, 14], [.true., .false., .false.], 'one cell across')
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Cells of one width: K(i,i+m) = exp(-x) I_m(x), x = (s/h)^2, of variance s^2 exactly.
  subroutine check_exact(ratio)
    real(wp), intent(in) :: ratio  !< s/h

    real(wp), parameter :: h(40) = 0.5_wp
    real(wp), allocatable :: row(:)
    integer :: reach, m
    character(len=40) :: name

    reach = kernel_reach(h, ratio*h(1))
    allocate (row(-reach:reach))
    row = kernel_row(h, .true., ratio*h(1), 0.0_wp, 7, reach)
    write (name, '(a,f0.1)') 's/h = ', ratio
    call expect_close(maxval(abs(row - [(scaled_bessel(abs(m), ratio**2), m=-reach, reach)])), 0.0_wp, 2e-10_wp*row(0), &
                      'exact kernel, '//trim(name))
    call expect_close(sum(row*[(m**2, m=-reach, reach)]), ratio**2, 1e-8_wp, 'variance, '//trim(name))
    call expect_close(sum(row), 1.0_wp, 1e-14_wp, 'sum, '//trim(name))
    call expect(all(row >= 0.0_wp), 'nothing negative, '//trim(name))
  end subroutine check_exact

  !> exp(-x) I_m(x) = (1/pi) integral over 0 to pi of exp(x (cos a - 1)) cos(m a) da, DLMF 10.32.3; sums over a whole period
  !> converge exponentially.
  pure function scaled_bessel(m, x) result(value)
    integer, intent(in) :: m
    real(wp), intent(in) :: x
    real(wp) :: value

    integer, parameter :: points = 4096
    real(wp) :: angle
    integer :: i

    value = 0.0_wp
    do i = 1, points
      angle = 2*acos(-1.0_wp)*i/points
      value = value + exp(x*(cos(angle) - 1.0_wp))*cos(m*angle)/points
    end do
  end function scaled_bessel

  !> What would go through a wall comes back as if from its mirror image.
  subroutine check_walls()
    real(wp), parameter :: h(50) = 0.2_wp, s = 0.5_wp
    real(wp), allocatable :: row(:)
    real(wp) :: expected, worst
    integer :: reach, m

    reach = kernel_reach(h, s)
    allocate (row(-reach:reach))
    row = kernel_row(h, .false., s, 0.0_wp, 3, reach)
    worst = 0.0_wp
    do m = -reach, reach
      expected = 0.0_wp
      if (3 + m >= 1) expected = scaled_bessel(abs(m), (s/h(1))**2) + scaled_bessel(abs(5 + m), (s/h(1))**2)
      worst = max(worst, abs(row(m) - expected))
    end do
    call expect_close(worst, 0.0_wp, 1e-10_wp, 'walls mirror')
  end subroutine check_walls

  !> Cells that grow by a tenth each: K(i,j)/h_j is symmetric, and the variance tends to s^2 with the cells.
  subroutine check_graded()
    real(wp) :: row(-200:200), h(60), middle(60), kernel(60, 60), variance
    integer :: i, j

    h = [(0.01_wp*1.03_wp**i, i=1, 60)]
    middle = [(sum(h(:i)) - 0.5_wp*h(i), i=1, 60)]
    do i = 1, 60
      row = kernel_row(h, .false., 0.05_wp, 0.1_wp, i, 200)
      kernel(i, :) = [(row(j - i), j=1, 60)]
    end do
    call expect_close(maxval(abs([(kernel(i, :)*h(i) - kernel(:, i)*h, i=1, 60)])), 0.0_wp, 1e-16_wp, 'graded: both ways alike')
    variance = sum(kernel(30, :)*(middle - middle(30))**2)
    call expect_close(variance, 0.05_wp**2 - 0.1_wp*h(30)**2, 0.02_wp, 'graded: variance')
    call expect(kernel_reach(h, 0.05_wp) > 7*0.05_wp/h(1), 'graded: reach')
  end subroutine check_graded

  !> Fields of the whole grid, the same on all ranks, spread in boxes and directly.
  subroutine check_boxes(n, periodic, name)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: name

    real(wp), parameter :: width = 0.31_wp, mapped = 1.0_wp/6.0_wp
    type(mesh_t) :: mesh
    type(boxes_t) :: boxes
    type(spreading_t) :: spreading
    type(outcome_t) :: outcome
    real(wp), dimension(components, n(1), n(2), n(3)) :: amount, field, given, taken, direct
    integer :: a

    mesh = new_uniform_mesh([0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 2.0_wp, 1.5_wp], n, periodic)
    call new_boxes(comm, n, periodic, boxes, outcome)
    if (outcome%failed()) error stop 'test_spreading: no boxes'
    call spreading%create(boxes, mesh, width, mapped, components)
    amount = reshape([(modulo(0.6180339887_wp*a, 1.0_wp), a=1, size(amount))], shape(amount))
    field = reshape([(modulo(0.7548776662_wp*a, 1.0_wp) - 0.5_wp, a=1, size(field))], shape(field))
    given = on_all_ranks(spreading, boxes, amount, .true.)
    taken = on_all_ranks(spreading, boxes, field, .false.)
    direct = amount
    do a = 1, 3
      call spread_directly(mesh, a, width, mapped, direct)
    end do
    if (.not. comm%is_root()) return
    call expect_close(maxval(abs(given - direct)), 0.0_wp, 1e-14_wp, 'as summed directly, '//name)
    do a = 1, components
      call expect_close(sum(given(a, :, :, :)), sum(amount(a, :, :, :)), 1e-13_wp, 'nothing is lost, '//name)
      call expect_close((sum(given(a, :, :, :)*field(a, :, :, :)) - sum(amount(a, :, :, :)*taken(a, :, :, :))) &
                        /sum(given(a, :, :, :)*abs(field(a, :, :, :))), 0.0_wp, 1e-14_wp, 'both ways alike, '//name)
    end do
    call expect(all(given > 0.0_wp), 'nothing negative, '//name)
    call expect(maxval(taken) - minval(taken) < 0.9_wp*(maxval(field) - minval(field)), 'smoother, '//name)
  end subroutine check_boxes

  !> A field of the whole grid after its boxes have been spread; that a uniform one stays so is tested on the way.
  function on_all_ranks(spreading, boxes, whole, giving) result(after)
    type(spreading_t), intent(inout) :: spreading
    type(boxes_t), intent(in) :: boxes
    real(wp), intent(in) :: whole(:,:,:,:)
    logical, intent(in) :: giving
    real(wp), allocatable :: after(:,:,:,:)

    real(wp), allocatable :: part(:,:,:,:)

    associate (lo => boxes%lo, hi => boxes%hi)
      allocate (part, source=0.0_wp*whole(:, lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)) + 2.5_wp)
      call spreading%take(components, part)
      if (any(abs(part - 2.5_wp) > 1e-14_wp)) call expect(.false., 'uniform fields stay so')
      part = whole(:, lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))
      if (giving) call spreading%give(components, part)
      if (.not. giving) call spreading%take(components, part)
      allocate (after, source=0.0_wp*whole)
      after(:, lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)) = part
    end associate
    after = reshape(comm%sum(reshape(after, [size(after)])), shape(after))
  end function on_all_ranks

  !> One direction of the whole grid.
  subroutine spread_directly(mesh, a, width, mapped, field)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: a
    real(wp), intent(in) :: width, mapped
    real(wp), intent(inout) :: field(:,:,:,:)

    real(wp) :: before(size(field, 1), size(field, 2), size(field, 3), size(field, 4)), h(mesh%n(a))
    real(wp), allocatable :: row(:)
    integer :: i, m, j, reach

    if (mesh%n(a) == 1) return
    before = field
    field = 0.0_wp
    h = mesh%finest(a)
    reach = kernel_reach(h, width)
    allocate (row(-reach:reach))
    do i = 1, mesh%n(a)
      row = kernel_row(h, mesh%periodic(a), width, mapped, i, reach)
      do m = -reach, reach
        j = modulo(i + m - 1, mesh%n(a)) + 1
        select case (a)
        case (1)
          field(:, j, :, :) = field(:, j, :, :) + row(m)*before(:, i, :, :)
        case (2)
          field(:, :, j, :) = field(:, :, j, :) + row(m)*before(:, :, i, :)
        case default
          field(:, :, :, j) = field(:, :, :, j) + row(m)*before(:, :, :, i)
        end select
      end do
    end do
  end subroutine spread_directly

end program test_spreading
