!> Parcels read from .csv and .h5 files: values, weights, mistakes with their line.
!> ranks: 1
program test_psd_parcel_file
  use check, only: expect, expect_close, finish
  use cloud, only: cloud_t
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use generator, only: generate
  use hdf5_arrays, only: put_columns, share_t
  use hdf5_file, only: hdf5_file_t, start_hdf5, stop_hdf5, real_kind
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use parcel_file, only: read_parcel_file
  use parcels_settings, only: parcels_settings_t, fill_settings_t
  use powder_settings, only: powder_settings_t
  use size_audit, only: size_audit_t
  use vessel, only: vessel_t
  use weighting, only: weighting_t
  implicit none

  character(len=*), parameter :: folder = 'build/tests/'
  type(communicator_t) :: comm
  type(vessel_t) :: vessel

  call start_ranks(comm)
  call start_hdf5()
  call execute_command_line('mkdir -p '//folder)
  vessel = vessel_t([0.0_wp, 0.0_wp, 0.0_wp], [0.1_wp, 0.1_wp, 0.1_wp], [.false., .false., .false.])
  call with_weights()
  call with_diameters()
  call sizes_only()
  call from_hdf5()
  call mistakes()
  call among_others()
  call stop_hdf5()
  call finish()
  call stop_ranks()

contains

  !> Write lines to a file and read it as parcels; SSW with W = 8 where the file says nothing.
  subroutine read_lines(lines, parcels, outcome)
    character(len=*), intent(in) :: lines(:)
    type(cloud_t), intent(out) :: parcels
    type(outcome_t), intent(out) :: outcome

    type(fill_settings_t) :: fill
    integer :: unit, i

    fill%file = folder//'parcels.csv'
    fill%velocity = [0.0_wp, 0.0_wp, 3.0_wp]
    open (newunit=unit, file=fill%file, action='write', status='replace')
    write (unit, '(a)') (trim(lines(i)), i=1, size(lines))
    close (unit)
    call read_parcel_file(fill, weighting_t(8.0_wp, 1.0_wp, 0.0_wp), vessel, parcels, outcome)
  end subroutine read_lines

  subroutine with_weights()
    type(cloud_t) :: parcels
    type(outcome_t) :: outcome

    call read_lines([character(len=60) :: '# a comment', 'W, d,x , y,z,vx,vy,vz', '27,1e-3,0.01,0.02,0.03,1,-2,.5', '', &
                     ' 1 ,2.0d-3, 0.04,+0.05,6E-2,0,0,0'//achar(13)], parcels, outcome)
    call expect(.not. outcome%failed() .and. parcels%n == 2, 'two parcels are read')
    if (outcome%failed()) return
    call expect_close(parcels%position(3, 1), 0.03_wp, 1.0e-15_wp, 'a position')
    call expect_close(parcels%position(2, 2), 0.05_wp, 1.0e-15_wp, 'another')
    call expect_close(parcels%velocity(2, 1), -2.0_wp, 1.0e-15_wp, 'a velocity')
    call expect_close(parcels%diameter(2), 2.0e-3_wp, 1.0e-15_wp, 'a diameter')
    call expect_close(parcels%weight(1), 27.0_wp, 1.0e-15_wp, 'a weight')
    call expect_close(parcels%contact_diameter(1), 3.0e-3_wp, 1.0e-15_wp, 'and the contact diameter d W^(1/3)')
  end subroutine with_weights

  subroutine with_diameters()
    type(cloud_t) :: parcels
    type(outcome_t) :: outcome

    call read_lines([character(len=40) :: 'x,y,z,d,D', '0.01,0.02,0.03,1e-3,2e-3'], parcels, outcome)
    call expect(.not. outcome%failed(), 'a file with D is read')
    call expect_close(parcels%weight(1), 8.0_wp, 1.0e-14_wp, 'its weight is (D/d)^3')
    call expect(abs(parcels%contact_diameter(1) - 2.0e-3_wp) <= 0.0_wp, 'its contact diameter is D')
    call expect_close(parcels%velocity(3, 1), 3.0_wp, 1.0e-15_wp, 'its velocity is that of the fill')
  end subroutine with_diameters

  subroutine sizes_only()
    type(cloud_t) :: parcels
    type(outcome_t) :: outcome

    call read_lines([character(len=40) :: 'x,y,z,d', '0.01,0.02,0.03,1e-3'], parcels, outcome)
    call expect(.not. outcome%failed(), 'a file without weights is read')
    call expect_close(parcels%weight(1), 8.0_wp, 1.0e-15_wp, 'its weights are those of the case')
  end subroutine sizes_only

  subroutine from_hdf5()
    character(len=*), parameter :: names(5) = ['x', 'y', 'z', 'd', 'W']
    type(hdf5_file_t) :: file
    type(outcome_t) :: outcome
    type(fill_settings_t) :: fill
    type(cloud_t) :: parcels
    integer :: i

    fill%file = folder//'parcels.h5'
    call file%create(trim(fill%file))
    do i = 1, size(names)
      call file%make('/'//names(i), real_kind, [3_i8])
      call put_columns(file, '/'//names(i), [0.01_wp, 0.02_wp, 0.03_wp]*i, share_t(3_i8, 0_i8, 3_i8))
    end do
    call file%close(outcome)
    call expect(.not. outcome%failed(), 'a .h5 file is written')
    call read_parcel_file(fill, weighting_t(8.0_wp, 1.0_wp, 0.0_wp), vessel, parcels, outcome)
    call expect(.not. outcome%failed() .and. parcels%n == 3, 'and read')
    if (outcome%failed()) return
    call expect_close(parcels%position(3, 2), 0.06_wp, 1.0e-15_wp, 'a position of the .h5 file')
    call expect_close(parcels%weight(3), 0.15_wp, 1.0e-15_wp, 'a weight of the .h5 file')
    fill%file = folder//'nothing.h5'
    call read_parcel_file(fill, weighting_t(8.0_wp, 1.0_wp, 0.0_wp), vessel, parcels, outcome)
    call expect(outcome%failed(), 'a .h5 file that does not exist is told')
  end subroutine from_hdf5

  subroutine mistakes()
    call expect_mistake([character(len=40) :: 'x,y,z,d,w', '0,0,0,1e-3,1'], ".csv:1: column 'w' is not one of x, y, z, d, W, D")
    call expect_mistake([character(len=40) :: 'x,y,z,d,x', '0,0,0,1e-3,1'], ".csv:1: column 'x' stands twice")
    call expect_mistake([character(len=40) :: 'x,y,d', '0,0,1e-3'], 'columns x, y, z and d are needed')
    call expect_mistake([character(len=40) :: 'x,y,z,d,W,D', '0,0,0,1e-3,1,1e-3'], 'give W or D, not both')
    call expect_mistake([character(len=40) :: 'x,y,z,d,vx', '0,0,0,1e-3,1'], 'all of vx, vy and vz')
    call expect_mistake([character(len=40) :: 'x,y,z,d', '0,0,0,1e-3', '0,0,1e-3'], '.csv:3: 3 values for 4 columns')
    call expect_mistake([character(len=40) :: 'x,y,z,d', '#', '0,zero,0,1e-3'], ".csv:3: y = 'zero' must be a real number")
    call expect_mistake([character(len=40) :: 'x,y,z,d', '0,1 2,0,1e-3'], ".csv:2: y = '1 2' must be a real number")
    call expect_mistake([character(len=40) :: 'x,y,z,d', '0,0,0,-1e-3'], '.csv:2: d = -0.001 must be positive')
    call expect_mistake([character(len=40) :: 'x,y,z,d', '0,0.2,0,1e-3'], '.csv:2: y = 0.2 m is outside the domain, 0 to 0.1')
    call expect_mistake([character(len=40) :: 'x,y,z,d'], 'holds no parcels')
    call expect_mistake([character(len=40) :: 'x,y,z,d', '9,9,9,-1', '9,9,9,-1', '9,9,9,-1'], 'and 2 more')
  end subroutine mistakes

  subroutine expect_mistake(lines, words)
    character(len=*), intent(in) :: lines(:)
    character(len=*), intent(in) :: words

    type(cloud_t) :: parcels
    type(outcome_t) :: outcome

    call read_lines(lines, parcels, outcome)
    if (outcome%failed()) then
      call expect(index(outcome%message, words) > 0, 'a mistake is told: '//words)
    else
      call expect(.false., 'a mistake is told: '//words)
    end if
  end subroutine expect_mistake

  !> A file's parcels and others in a box around them; two of a file in one place.
  subroutine among_others()
    type(cloud_t) :: parcels
    type(outcome_t) :: outcome
    type(powder_settings_t) :: powders(1)
    type(parcels_settings_t) :: settings
    type(fill_settings_t) :: fills(2)
    type(size_audit_t), allocatable :: audits(:)

    powders%id = 'beads'
    powders%density = 1000.0_wp
    powders%mean_diameter = 4.0e-3_wp
    fills%powder = 1
    fills(1)%number = 300
    fills(1)%lower = 0.0_wp
    fills(1)%upper = [0.05_wp, 0.05_wp, 0.05_wp]
    fills(2)%file = folder//'parcels.csv'
    call read_lines([character(len=40) :: 'x,y,z,d', '0.025,0.025,0.025,20e-3'], parcels, outcome)
    call generate(powders, settings, fills, vessel, parcels, audits, outcome)
    call expect(.not. outcome%failed() .and. parcels%n == 301, 'parcels are placed round one of a file')
    call expect(all(abs(parcels%position(:, 301) - 0.025_wp) <= 0.0_wp), 'which stays where the file says')
    call expect(minval(norm2(parcels%position(:, :300) - 0.025_wp, 1)) >= 12.0e-3_wp, 'and which none touches')
    call expect(audits(1)%parcels == 301, 'and which is counted')
    call read_lines([character(len=40) :: 'x,y,z,d', '0.08,0.08,0.08,4e-3', '0.08,0.08,0.0877,4e-3'], parcels, outcome)
    call generate(powders, settings, fills, vessel, parcels, audits, outcome)
    call expect(.not. outcome%failed() .and. parcels%n == 302, 'parcels of a file may touch, as in a bed at rest')
    call read_lines([character(len=40) :: 'x,y,z,d', '0.08,0.08,0.08,4e-3', '0.08,0.08,0.081,4e-3'], parcels, outcome)
    call generate(powders, settings, fills, vessel, parcels, audits, outcome)
    call expect(outcome%failed(), 'two parcels of a file in one place are told')
  end subroutine among_others

end program test_psd_parcel_file
