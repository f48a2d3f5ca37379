!> Particles among others of other sizes: the mean around each, and the drag that follows, on any number of ranks.
program test_coupling_sizes
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use coupling_scene, only: scene_t, build, add, step, set_gas, viscosity, density
  use drag_law, only: drag_law_t, new_drag_law
  use kinds, only: wp
  use sizes_beetstra, only: among_sizes_beetstra
  use sizes_cello, only: among_sizes_cello
  use sizes_yin_sundaresan, only: among_sizes_yin_sundaresan
  implicit none

  real(wp), parameter :: small = 2.0e-4_wp, large = 4.0e-4_wp  !< [m]
  real(wp), parameter :: scale = 0.01_wp                       !< edge of the domain [m]
  type(communicator_t) :: comm

  call start_ranks(comm)
  call check_mixture('beetstra', 'beetstra')
  call check_mixture('koch_hill', 'beetstra')
  call check_mixture('beetstra', 'yin_sundaresan')
  call check_mixture('cello', 'cello')
  call check_one_size('beetstra', 1.064_wp)
  call check_one_size('yin_sundaresan', 1.0_wp)
  call check_places()
  call check_off()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Both sizes, of the same volume together, in every cell; heavy, so that they stay in the gas that rises at 0.3 m/s.
  subroutine check_mixture(drag, polydispersity)
    character(len=*), intent(in) :: drag, polydispersity

    type(scene_t) :: scene
    real(wp) :: mean, error(2), expected, force
    integer :: n

    call build(comm, scale, [4, 8, 4], [.true., .true., .true.], drag, scene, polydispersity=polydispersity)
    call set_gas(scene, [0.0_wp, 0.3_wp, 0.0_wp], spread(0.0_wp, 1, 3))
    call fill_cells(scene, small, 0.15_wp)
    call fill_cells(scene, large, 0.15_wp)
    call step(scene, 1.0e-7_wp)
    mean = 1/(0.5_wp/small + 0.5_wp/large)
    n = scene%parcels%n
    error = 0.0_wp
    associate (sizes => scene%coupling%sizes)
      if (n > 0) error = [maxval(abs(sizes%mean(:n)/mean - 1)), maxval(abs(sizes%spread(:n) - 1.125_wp))]
    end associate
    error = [comm%max(error(1)), comm%max(error(2))]
    force = scene%coupling%exchange%drag(2)
    expected = drag_on(drag, polydispersity, small, mean) + drag_on(drag, polydispersity, large, mean)
    if (.not. comm%is_root()) return
    call expect_close(error(1), 0.0_wp, 1e-13_wp, 'every parcel has the mean of the bed, '//polydispersity)
    call expect_close(error(2), 0.0_wp, 1e-13_wp, 'and its sum of x y, '//polydispersity)
    call expect_close(force, expected, 1e-5_wp, 'drag of '//drag//' on both sizes, '//polydispersity)
  end subroutine check_mixture

  !> One parcel in the middle of every cell.
  subroutine fill_cells(scene, d, solids)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: d, solids  !< [m], volume fraction

    integer :: i, j, k

    do k = 1, scene%mesh%n(3)
      do j = 1, scene%mesh%n(2)
        do i = 1, scene%mesh%n(1)
          call add(scene, scene%mesh%finest*([i, j, k] - 0.5_wp), spread(0.0_wp, 1, 3), d, 1.0e6_wp, &
                   solids*product(scene%mesh%finest)/(pi/6*d**3))
        end do
      end do
    end do
  end subroutine fill_cells

  !> On all particles of one size, solids 0.15 of 0.3, gas at 0.3 m/s [N].
  function drag_on(drag, polydispersity, d, mean) result(force)
    character(len=*), intent(in) :: drag, polydispersity
    real(wp), intent(in) :: d, mean  !< [m]
    real(wp) :: force

    real(wp), parameter :: eps = 0.7_wp, u = 0.3_wp
    type(drag_law_t) :: law
    real(wp) :: factor

    law = new_drag_law(drag)
    factor = law%factor_at(density*eps*u*mean/viscosity, eps)
    select case (polydispersity)
    case ('beetstra')
      factor = among_sizes_beetstra(factor, d/mean)
    case ('yin_sundaresan')
      factor = among_sizes_yin_sundaresan(factor, eps, d/mean)
    case default
      factor = among_sizes_cello(factor, eps, d/mean, 1.125_wp)
    end select
    force = 3*pi*viscosity*d*eps*factor*u*(0.15_wp*2*scale**3/(pi/6*d**3))
  end function drag_on

  !> A bed of one size feels what it would without the effect, times what the law has for one size.
  subroutine check_one_size(polydispersity, ratio)
    character(len=*), intent(in) :: polydispersity
    real(wp), intent(in) :: ratio  !< [-]

    character(len=14) :: choices(2)
    type(scene_t) :: scene
    real(wp) :: force(2)
    integer :: i

    choices = [character(len=14) :: 'none', polydispersity]
    do i = 1, 2
      call build(comm, scale, [4, 8, 4], [.true., .true., .true.], 'beetstra', scene, &
                 polydispersity=trim(choices(i)))
      call set_gas(scene, [0.0_wp, 0.3_wp, 0.0_wp], spread(0.0_wp, 1, 3))
      call fill_cells(scene, small, 0.4_wp)
      call step(scene, 1.0e-7_wp)
      force(i) = scene%coupling%exchange%drag(2)
    end do
    if (comm%is_root()) call expect_close(force(2)/force(1), ratio, 1e-6_wp, 'a bed of one size, '//polydispersity)
  end subroutine check_one_size

  !> Two parcels a cell apart, one a quarter beyond its centre: the moments at each are those of the cells, by the weights.
  subroutine check_places()
    type(scene_t) :: scene
    real(wp) :: mean(2), cells(2), v(2)
    integer :: i

    call build(comm, scale, [4, 8, 4], [.false., .false., .false.], 'beetstra', scene, polydispersity='beetstra')
    call add(scene, scene%mesh%finest*[1.75_wp, 3.5_wp, 1.5_wp], spread(0.0_wp, 1, 3), small, 2500.0_wp, 30.0_wp)
    call add(scene, scene%mesh%finest*[2.5_wp, 3.5_wp, 1.5_wp], spread(0.0_wp, 1, 3), large, 2500.0_wp, 2.0_wp)
    call scene%coupling%map_void_fraction(scene%parcels, scene%gas)
    mean = 0.0_wp
    do i = 1, scene%parcels%n
      mean(merge(1, 2, scene%parcels%diameter(i) < 3.0e-4_wp)) = scene%coupling%sizes%mean(i)
    end do
    mean = comm%sum(mean)
    v = [30*small**3, 2*large**3]
    ! Cells 2 and 3 have 0.75 v(1) and 0.25 v(1) + v(2); the first parcel reads both, the second its own alone.
    cells = [0.75_wp**2 + 0.25_wp**2, 0.25_wp]
    if (.not. comm%is_root()) return
    call expect_close(mean(1), (cells(1)*v(1) + 0.25_wp*v(2))/(cells(1)*v(1)/small + 0.25_wp*v(2)/large), 1e-13_wp, &
                      'the mean around a parcel between cells')
    call expect_close(mean(2), (cells(2)*v(1) + v(2))/(cells(2)*v(1)/small + v(2)/large), 1e-13_wp, &
                      'the mean around a parcel in the middle of one')
  end subroutine check_places

  !> Without the effect there is nothing of it.
  subroutine check_off()
    type(scene_t) :: scene

    call build(comm, scale, [4, 8, 4], [.true., .true., .true.], 'beetstra', scene)
    if (comm%is_root()) call expect(.not. allocated(scene%coupling%sizes), 'no sizes are kept for ''none''')
  end subroutine check_off

end program test_coupling_sizes
